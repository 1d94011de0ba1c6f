"""The fixed set of cases by which two versions are compared: what is in it, that it resumes, and that it says how far it is."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from exo_sim.physics.declaration import declared
from exo_sim.trials.hidden_effects import CALIBRATIONS, EFFECTS, LISTED, OUTSIDE, SENSORS

#: What no case conceals: richer forms of another effect, a number of the numerics, a curve for what has no name.
NOT_CONCEALED = {"friction_smoothing", "heat_transfer_law", "unknown", "valve_characteristic", "valve_edges"}


@pytest.fixture
def answers(repository: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(repository / "scripts"))
    return importlib.import_module("answers.cases")


def test_the_set_holds_every_effect_and_every_kind_of_case(answers: ModuleType) -> None:
    alone, pairs, legs, special, real = answers.kinds()
    assert set(alone) == {key.replace(":", "-") for key in EFFECTS} and {*LISTED, *SENSORS, *CALIBRATIONS, *OUTSIDE} <= set(EFFECTS)
    assert set(declared()) - {key.split(":")[0] for key in EFFECTS} == NOT_CONCEALED
    assert all(len(case.effects) == 2 for case in pairs.values()) and len(pairs) >= 5 and len(legs) >= 3 and len(real) >= 5
    assert sum(bool(case.conditions.missing) for case in special.values()) >= 3
    assert len(alone) + len(pairs) + len(legs) + len(special) >= 40


def test_the_first_of_the_set_are_of_every_kind(answers: ModuleType, repository: Path) -> None:
    found = answers.names(repository)
    assert len(found) == len(set(found))
    for kind in answers.kinds()[:4]:
        assert set(found[:5]) & set(kind)


def test_what_was_answered_is_not_asked_again(answers: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    worker = importlib.import_module("answers.worker")
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "status").write_text("0\n")
    worker.ask(tmp_path / "no checkout", tmp_path / "no cases", tmp_path, ["one", "two"], 1)
    assert capsys.readouterr().err == f"2 of 2 are answered already in {tmp_path}\n"


def test_the_list_is_cut(repository: Path) -> None:
    said = subprocess.run(
        [sys.executable, str(repository / "scripts" / "same_answers"), "--list", "--first", "3"], capture_output=True, text=True, check=True
    )
    assert len(said.stdout.split()) == 3
