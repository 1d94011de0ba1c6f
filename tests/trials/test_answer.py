"""What a tool answered, in the types of the contract: what is of another type is as if it were not there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from exo_sim.trials.answer import read_answer, tidied


@pytest.mark.parametrize("answer", [None, 3, [], {}, {"effects": "none"}])
def test_no_answer(answer: Any) -> None:
    assert tidied(answer) is None


def test_an_answer_keeps_what_counts() -> None:
    found = tidied({
        "verdict": "mismatch", "effects": [
            {"name": "valve_lag", "where": "piston", "kind": 3, "parameters": {"delay": {"value": 5e-3, "low": True, "high": float("inf")}},
             "evidence": {"log10_odds": 4.0, "probability": "high"}, "ambiguous_with": ["a", {"name": "b"}, 7], "probability": 10**400},
            {"where": "nameless"}, "no effect",
        ], "located": [{"where": "piston", "equation": 1}, 2], "fit": {"held_out": [[1, 2], [1, "x"], 3], "signal": {"p": {"after": 2.0}}},
    })  # fmt: skip
    assert found is not None
    (effect,) = found["effects"]
    assert effect["parameters"] == {"delay": {"value": 5e-3}} and effect["kind"] == "" and "probability" not in effect
    assert effect["evidence"] == {"log10_odds": 4.0} and effect["ambiguous_with"] == ["a", "b"]
    assert found["located"] == [{"where": "piston", "equation": ""}]
    assert found["fit"]["held_out"] == [[1, 2]] and found["fit"]["signal"] == {"p": {"after": 2.0}}
    assert tidied(found) == found


def test_a_file_that_is_no_json_is_no_answer(tmp_path: Path) -> None:
    (tmp_path / "d.json").write_text("{")
    assert read_answer(tmp_path / "d.json") is None and read_answer(tmp_path / "e.json") is None
