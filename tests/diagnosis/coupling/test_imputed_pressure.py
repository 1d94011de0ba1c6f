"""Machines of which one pressure was not recorded: friction, springs and the unseen chamber's own leak are found all the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from exo_sim.diagnosis.coupling.imputed_pressure import _possible_range, with_initial_pressure
from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions


def folder_of(tmp_path: Path, effects: tuple[str, ...], seed: int, gone: int, oddities: bool = False) -> Path:
    under = Conditions(duration=8.0, missing=(f"piston.pressure_{gone}",), oddities=oddities)
    case = make_case("case", effects, seed, conditions=under)
    write_case(case, tmp_path, "csv", open_truth=True)
    return tmp_path


def diagnosed(folder: Path, rig: str = "rig.toml") -> Diagnosis:
    return diagnose([folder / "recording.csv"], folder / rig, folder=folder, jobs=1)


def named(found: Diagnosis) -> list[tuple[str, str]]:
    return [(finding.name, finding.where) for finding in found.effects if finding.kind != "calibration"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "gone", "parameter"),
    [
        ("return_spring", 2, "stiffness"),
        ("pressure_dependent_friction", 1, "coefficient"),
        ("external_leakage:chamber_2", 2, "area_2"),
    ],
)
def test_it_is_named_with_one_pressure_missing(tmp_path: Path, effect: str, gone: int, parameter: str) -> None:
    case = make_case("case", (effect,), 7201, conditions=Conditions(duration=8.0, missing=(f"piston.pressure_{gone}",)))
    write_case(case, tmp_path, "csv")
    found = diagnosed(tmp_path)
    assert named(found) == [(effect.split(":")[0], "piston")]
    number = next(f for f in found.effects if f.kind != "calibration").parameters[parameter]
    assert number.value == pytest.approx(case.hidden[0].parameters[parameter], rel=0.12)
    assert any(f"pressure_{gone} was not recorded" in remark for remark in found.sensor_remarks)
    (tmp_path / "improved.toml").write_text(found.improved)
    assert named(diagnosed(tmp_path, "improved.toml")) == []


@pytest.mark.slow
@pytest.mark.parametrize("gone", [1, 2])
def test_a_healthy_machine_stays_healthy(tmp_path: Path, gone: int) -> None:
    found = diagnosed(folder_of(tmp_path, (), 7010, gone, oddities=True))
    assert named(found) == []
    assert found.verdict in ("consistent", "calibration")
    assert not any("balance of forces" in question.question for question in found.open_questions)


@pytest.mark.parametrize("gone", [1, 2])
def test_the_forces_say_with_which_pressure_a_chamber_began(tmp_path: Path, gone: int) -> None:
    under = Conditions(duration=2.0, known=(), missing=(f"piston.pressure_{gone}",))
    case = make_case("case", (), 7010, conditions=under, keep_states=True)
    write_case(case, tmp_path, "csv")
    gathered = gather([tmp_path / "recording.csv"], tmp_path / "rig.toml")
    run = with_initial_pressure(gathered, gathered.cylinders["piston"][0])
    truth = float(case.truth[0].log[f"pressure_{gone}"][0])
    dry = 0.01 * 7e5  # what the nominal numbers and a trace of friction may hide
    assert run.initial[gone - 1] == pytest.approx(truth, abs=dry + 0.05 * truth)
    assert np.isnan(run.initial[2 - gone])


@pytest.mark.slow
def test_what_has_no_name_is_left_open(tmp_path: Path) -> None:
    found = diagnosed(folder_of(tmp_path, ("cogging",), 7203, 2))
    assert found.verdict == "undetermined" and named(found) == []
    assert any("the rest of the balance of forces" in question.question for question in found.open_questions)


def test_nobody_knows_what_a_chamber_did_while_nothing_was_recorded(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, (), 7010, 2)
    rows = (folder / "recording.csv").read_text().splitlines(keepends=True)
    (folder / "recording.csv").write_text("".join(rows[:3000] + rows[5000:]))
    gathered = gather([folder / "recording.csv"], folder / "rig.toml")
    run = gathered.cylinders["piston"][0]
    assert with_initial_pressure(gathered, run) is run


@pytest.mark.parametrize("supply", [7e5, 0.9e5])
def test_a_chamber_begins_between_nothing_and_what_the_machine_has(tmp_path: Path, supply: float) -> None:
    gathered = gather([folder_of(tmp_path, (), 7010, 2) / "recording.csv"], tmp_path / "rig.toml")
    run = replace(gathered.cylinders["piston"][0], supply=np.full(10, supply))
    low, high = _possible_range(gathered, run)
    assert 0.0 < low < gathered.rig.environment.pressure < high
    assert run.pressure[0] is not None and high >= np.nanmax(run.pressure[0])


def test_a_recording_with_both_needs_no_forces(tmp_path: Path) -> None:
    write_case(make_case("case", (), 7010, conditions=Conditions(duration=2.0)), tmp_path, "csv")
    gathered = gather([tmp_path / "recording.csv"], tmp_path / "rig.toml")
    run = gathered.cylinders["piston"][0]
    assert with_initial_pressure(gathered, run) is run
