"""What a benchmark says: a number with its target, or a remark."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Asked:
    """What the command line asked for beyond the usual: a start from an empty cache, and parts that take many minutes."""

    cold: bool = False
    long: bool = False


@dataclass(frozen=True)
class Figure:
    """One measured number.

    Attributes:
        key: Its name in the JSON.
        label: What it is, in the first column of the table.
        value: In the unit that `form` names.
        form: How it is printed, e.g. "{:.2f} s".
        below, above: Target, in the same unit; None where there is none.
    """

    key: str
    label: str
    value: float
    form: str = "{:.2f}"
    below: float | None = None
    above: float | None = None

    @property
    def target(self) -> str:
        """The target as the JSON says it, or ""."""
        if self.below is not None:
            return f"< {self.below:g}"
        return f"> {self.above:g}" if self.above is not None else ""

    @property
    def met(self) -> bool:
        """Whether the target is met; True where there is none."""
        return (self.below is None or self.value < self.below) and (self.above is None or self.value > self.above)

    def line(self) -> str:
        """Return the row of the table."""
        judged = f"   target {self.target}: {'met' if self.met else 'MISSED'}" if self.target else ""
        return f"{self.label:<40} {self.form.format(self.value)}{judged}"


Said = Sequence[Figure | str]


def as_json(said: Said) -> dict[str, object]:
    """Return one object: every figure under its key (null where it is infinite), targets and whether they are met, remarks."""
    figures = [one for one in said if isinstance(one, Figure)]
    return {
        "schema": "exo-sim/benchmark/1",
        **{one.key: one.value if math.isfinite(one.value) else None for one in figures},
        "targets": {one.key: {"target": one.target, "met": one.met} for one in figures if one.target},
        "remarks": [one for one in said if isinstance(one, str)],
    }
