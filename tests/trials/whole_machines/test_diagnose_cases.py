"""Answers of rivals to whole machines: whatever one writes, the marks of all come."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from exo_sim.trials.whole_machines.diagnose_cases import marks

_TRUTH = {"case": "one", "cell": "c", "make": "A", "reported_only": False, "hidden": [], "beside": [], "known": [], "columns": {}}
_WRONG = {"name": ["a"], "where": 3, "parameters": [1], "evidence": "strong", "probability": "high", "ambiguous_with": 5}


@pytest.mark.parametrize(
    ("answer", "answered"),
    [
        (b"{", False), (b"\xff", False), (b"[" * 100_000, False), (b"[]", False), (b'{"effects": 3}', False),
        (json.dumps({"effects": [_WRONG, {**_WRONG, "name": "coulomb_friction"}, None]}).encode(), True),
        (b'{"effects": [{"name": "leak", "parameters": {"a": {"value": ' + b"9" * 400 + b"}}}]}", True),
    ],
)  # fmt: skip
def test_an_answer_that_is_none_stops_nobody(tmp_path: Path, answer: bytes, answered: bool) -> None:
    (tmp_path / "cases" / "one" / "truth").mkdir(parents=True)
    (tmp_path / "cases" / "one" / "truth" / "truth.json").write_text(json.dumps(_TRUTH))
    out = tmp_path / "out" / "one"
    out.mkdir(parents=True)
    (out / "spent.json").write_text("{}")
    (out / "diagnosis.json").write_bytes(answer)
    (mark,) = marks(tmp_path / "cases", tmp_path / "out")
    assert mark.answered is answered
