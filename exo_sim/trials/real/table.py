"""Marks of real machines to tables: a line for each case, and one for each make of rig."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from exo_sim.trials.real.judge import WORSE, Mark

CASES = (
    "case", "verdict", "found", "missed", "must not be there", "unknown", "before/honest", "after/honest", "after/before", "names", "rig",
    "mark", "cpu s",
)  # fmt: skip
MAKES = (
    "make of rig", "cases", "answered", "mean mark", "must be named, are", "with a name that must not be there", "after/honest, median",
    "most", "worse than handed in", "cpu s, median", "most",
)  # fmt: skip


def by_make(marks: Sequence[Mark]) -> dict[str, list[Mark]]:
    """Return the marks of each make of rig, in the order in which they come."""
    return {make: [mark for mark in marks if mark.make == make] for make in dict.fromkeys(mark.make for mark in marks)}


def case_rows(marks: Sequence[Mark]) -> list[list[str]]:
    """Return a line for each mark; see `CASES`."""
    return [
        [
            mark.case, mark.verdict or "none", ", ".join(mark.found), ", ".join(mark.missed), ", ".join(mark.forbidden),
            ", ".join(mark.unknown), _number(mark.before_over_honest), _number(mark.over_honest), _number(mark.over_before),
            f"{mark.names:.2f}", f"{mark.errors:.2f}", f"{mark.mark:.2f}", _number(mark.cpu_s),
        ]
        for mark in marks
    ]  # fmt: skip


def make_rows(marks: Sequence[Mark]) -> list[list[str]]:
    """Return a line for each make of rig, and one for all; see `MAKES`."""
    groups = by_make(marks)
    return [_row(make, those) for make, those in [*groups.items(), *([("all", marks)] if len(groups) > 1 else [])]]


def _row(name: str, marks: Sequence[Mark]) -> list[str]:
    found = summary(marks)
    return [
        name, str(found["cases"]), str(found["answered"]), f"{found['mark']:.2f}", f"{found['named']} of {found['to_be_named']}",
        str(found["with_a_forbidden_name"]), _number(found["median_over_honest"]), _number(found["most_over_honest"]),
        ", ".join(found["worse_than_handed_in"]), _number(found["median_cpu_s"]), _number(found["most_cpu_s"]),
    ]  # fmt: skip


def summary(marks: Sequence[Mark]) -> dict[str, Any]:
    """Return the mean mark, how many names were given that must and that must not be, and what became of the rigs.

    Args:
        marks: At least one.
    """
    over = [mark.over_honest for mark in marks if mark.over_honest is not None]
    spent = [mark.cpu_s for mark in marks if mark.cpu_s is not None]
    return {
        "cases": len(marks),
        "answered": sum(bool(mark.verdict) for mark in marks),
        "mark": float(np.mean([mark.mark for mark in marks])),
        "named": sum(len(mark.found) for mark in marks),
        "to_be_named": sum(len(mark.found) + len(mark.missed) for mark in marks),
        "with_a_forbidden_name": sum(bool(mark.forbidden) for mark in marks),
        "median_over_honest": float(np.median(over)) if over else None,
        "most_over_honest": max(over) if over else None,
        "worse_than_handed_in": [mark.case for mark in marks if mark.over_before is not None and mark.over_before > WORSE],
        "median_cpu_s": float(np.median(spent)) if spent else None,
        "most_cpu_s": max(spent) if spent else None,
    }


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"
