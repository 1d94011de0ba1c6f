"""A number with its unit, its derivation and the experiment that set it."""

from __future__ import annotations

#: What is said where no experiment set a number: it is as large as `why` makes it, and was not varied.
CONVENTION = "convention, not measured"


class Number(float):
    """A number that decides.

    Attributes:
        unit: What it counts.
        why: What it decides, and why it is about so large.
        set_by: The experiment that set it.
    """

    unit: str
    why: str
    set_by: str

    def __new__(cls, value: float, unit: str = "", why: str = "", set_by: str = CONVENTION) -> Number:
        number = super().__new__(cls, value)
        number.unit, number.why, number.set_by = unit, why, set_by
        return number


class Count(int):
    """A whole number that decides; its attributes are those of `Number`."""

    unit: str
    why: str
    set_by: str

    def __new__(cls, value: int, unit: str = "", why: str = "", set_by: str = CONVENTION) -> Count:
        count = super().__new__(cls, value)
        count.unit, count.why, count.set_by = unit, why, set_by
        return count
