"""Scores of several tools side by side, from what `trial score` writes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from exo_sim.trials import protocol
from exo_sim.trials.case_mix import draw_plans
from exo_sim.trials.score import score


def table(repository: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(repository / "scripts" / "trial_table"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_two_tools_on_the_same_cases(repository: Path, tmp_path: Path) -> None:
    folder, key = tmp_path / "trial", tmp_path / "trial.key"
    protocol.make(folder, draw_plans(6, 5), key, duration=4.0, quiet=True)
    protocol.run(folder, f"{sys.executable} -m exo_sim.trials.rivals nothing", quiet=True)
    found = score(folder, key)["figures"]
    said = table(repository, f"blind={folder}", f"again={folder}")
    assert said.returncode == 0, said.stderr
    rows = {row.split("|")[1].strip(): [cell.strip() for cell in row.split("|")[2:4]] for row in said.stdout.splitlines()}
    assert rows[""] == ["blind", "again"]
    clean = found["false_alarms"]
    assert rows["false alarms where nothing is hidden"][0].startswith("0 % (0 to") and clean["hits"] == 0
    assert rows["exact set of names"][0].endswith(f"of {found['exact_set']['of']}")
    assert rows["95 % intervals that cover"] == ["-", "-"]


def test_a_folder_without_a_score_is_named(repository: Path, tmp_path: Path) -> None:
    said = table(repository, f"blind={tmp_path}")
    assert said.returncode == 2 and str(tmp_path) in said.stderr and "trial score" in said.stderr and not said.stdout
    (tmp_path / "score.json").write_text(json.dumps({"figures": {}}))
    assert table(repository, "blind").returncode == 2
