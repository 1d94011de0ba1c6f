"""Marks of real machines as tables."""

from __future__ import annotations

import pytest

from exo_sim.trials.real.case import Known, Name
from exo_sim.trials.real.judge import Mark, judge
from exo_sim.trials.real.table import CASES, MAKES, case_rows, make_rows, summary

KNOWN = Known(must=(Name(("viscous_friction",), ("arm",)),), may=(), unknown=False, published={}, source="")


def marked(case: str, make: str, name: str, after: float) -> Mark:
    diagnosis = {"verdict": "mismatch", "effects": [{"name": name, "where": "arm", "kind": "missing_physics"}]}
    return judge(case, KNOWN, diagnosis, {"arm.position": 4.0}, {"arm.position": after}, {"arm.position": 2.0}, after, make=make)


MARKS = (marked("a", "one", "viscous_friction", 2.0), marked("b", "two", "backlash", 6.0), marked("c", "one", "viscous_friction", 3.0))


def test_a_line_for_each_case() -> None:
    rows = case_rows(MARKS)
    assert all(len(row) == len(CASES) for row in rows) and [row[0] for row in rows] == ["a", "b", "c"]
    line = dict(zip(CASES, rows[1]))
    assert (line["must not be there"], line["before/honest"], line["after/honest"], line["mark"]) == ("backlash (arm)", "2", "3", "0.00")


def test_a_line_for_each_make_of_rig_and_one_for_all() -> None:
    rows = [dict(zip(MAKES, row)) for row in make_rows(MARKS)]
    assert [row["make of rig"] for row in rows] == ["one", "two", "all"]
    assert [row["must be named, are"] for row in rows] == ["2 of 2", "0 of 1", "2 of 3"]
    assert [row["worse than handed in"] for row in rows] == ["", "b", "b"]
    assert [row["after/honest, median"] for row in rows] == ["1.25", "3", "1.5"]
    assert len(make_rows(MARKS[:1])) == 1


def test_the_summary_counts() -> None:
    found = summary(MARKS)
    assert found["with_a_forbidden_name"] == 1 and found["most_over_honest"] == pytest.approx(3.0)
    assert found["mark"] == pytest.approx(sum(mark.mark for mark in MARKS) / 3) and found["median_cpu_s"] == 3.0
