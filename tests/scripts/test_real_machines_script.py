"""`scripts/real_machines` as a user calls it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

NOTHING = """import json, pathlib
pathlib.Path("out").mkdir()
pathlib.Path("out/diagnosis.json").write_text(json.dumps({"verdict": "undetermined", "effects": []}))
"""


def called(repository: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(repository / "scripts" / "real_machines"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_machine_that_is_not_there_and_a_folder_without_recordings(repository: Path, tmp_path: Path) -> None:
    said = called(repository, str(tmp_path / "out"), "--only", "kdm")
    assert said.returncode == 2 and 'no real machine "kdm"; did you mean "kdn"?' in said.stderr and not said.stdout
    said = called(repository, str(tmp_path / "out"), "--only", "kdn", "--data", str(tmp_path / "nowhere"))
    assert said.returncode == 2 and "nowhere" in said.stderr and "Traceback" not in said.stderr


@pytest.mark.real_data
def test_a_machine_as_tables_and_as_json(repository: Path, shared_data: Path, tmp_path: Path) -> None:
    (tmp_path / "tool.py").write_text(NOTHING)
    line = [str(tmp_path / "out"), "--only", "upright", "--data", str(shared_data), "--tool", f"{sys.executable} {tmp_path / 'tool.py'}"]
    said = called(repository, *line)
    assert said.returncode == 0, said.stderr
    rows = [row.split("|")[1].strip() for row in said.stdout.splitlines() if row.startswith("|")]
    assert rows == ["case", "---", "upright", "make of rig", "---", "upright cylinder"]
    again = called(repository, *line, "--json")
    content = json.loads(again.stdout)
    assert content == json.loads((tmp_path / "out" / "marks.json").read_text())
    assert content["makes"]["upright cylinder"] == content["summary"] and content["marks"][0]["verdict"] == "undetermined"
    assert content["marks"][0]["names"] == 1.0 and content["marks"][0]["errors"] == 0.0  # it wrote no rig
