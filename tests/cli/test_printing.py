"""Data goes to stdout or into a file, words to stderr."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from exo_sim.cli.printing import remark, show


def test_one_json_object_or_text_and_never_both(capsys: pytest.CaptureFixture[str]) -> None:
    show({"a": 1.0}, "a is one\n\n", as_json=False)
    assert capsys.readouterr().out == "a is one\n"
    show({"a": float("nan")}, "a is one", as_json=True)
    assert json.loads(capsys.readouterr().out) == {"a": None}


def test_into_a_file_nothing_is_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    show({"a": 1}, "words", as_json=True, out=tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": 1} and capsys.readouterr().out == ""


def test_remarks_go_to_stderr_unless_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    remark("a remark")
    remark("another", quiet=True)
    assert capsys.readouterr() == ("", "a remark\n")
