"""Errors of the whole machine over the time that numbers are fitted to."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.policy.budgets import BLOCKS, LEAD
from exo_sim.diagnosis.validation import training_runs
from exo_sim.diagnosis.validation.training_runs import TrainingRuns
from exo_sim.rig import Rig
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions
from exo_sim.trials.oracle import oracle_rig


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory: pytest.TempPathFactory) -> tuple[MachineData, Rig]:
    """A bench with hidden dry friction, and its rig with the truth in it."""
    folder: Path = tmp_path_factory.mktemp("rubbing")
    write_case(make_case("a", ("coulomb_friction",), 11, 0.5, Conditions(duration=10.0, known=())), folder, "parquet", open_truth=True)
    truth = oracle_rig((folder / "rig.toml").read_text(), json.loads((folder / "truth.json").read_text())["hidden"])
    return gather([folder / "recording.parquet"], folder / "rig.toml"), rigs.parse(truth, folder / "rig.toml")


def kept(data: MachineData) -> Split:
    return Split({data.recordings[0].name: ((7.0, 10.0),)})


def squares(runs: TrainingRuns, rig: Rig) -> dict[str, float]:
    errors = runs.errors(rig)
    assert errors is not None
    return {key: float(own @ own) / len(own) for key, own in errors.items()}


def test_the_true_rig_is_missed_by_less_than_a_third_of_what_the_one_handed_in_is(rubbing: tuple[MachineData, Rig]) -> None:
    data, true = rubbing
    runs = TrainingRuns(data, kept(data), data.rig)
    before, after = squares(runs, data.rig), squares(runs, true)
    assert set(before) == {"piston.pressure_1", "piston.pressure_2", "slide.position"}
    assert all(9.0 * after[key] < before[key] for key in before)


def test_what_is_held_out_takes_no_part(rubbing: tuple[MachineData, Rig]) -> None:
    data, true = rubbing
    table = data.as_read[0]
    later = 2e-3 * (1.0 - np.cos(4.0 * np.clip(table.time - 7.2, 0.0, None)))
    moved = {key: values + later * (key == "slide.position") for key, values in table.columns.items()}
    other = replace(data, as_read=(replace(table, columns=moved),))
    one, two = (squares(TrainingRuns(each, kept(each), true), true) for each in (data, other))
    assert two == pytest.approx(one, rel=0.02)
    whole = squares(TrainingRuns(other, Split({}), true), true)
    assert whole["slide.position"] > 4.0 * two["slide.position"]


def test_errors_that_stand_together_count_for_fewer_samples_than_those_that_do_not(rubbing: tuple[MachineData, Rig]) -> None:
    data, true = rubbing
    runs = TrainingRuns(data, kept(data), data.rig)
    errors = runs.errors(true)
    assert errors is not None
    n = len(errors["slide.position"])
    white = np.random.default_rng(0).normal(size=n)
    slow = np.convolve(white, np.ones(40) / 40.0, mode="same")
    assert runs.independent({"slide.position": white})["slide.position"] > 0.8 * n
    assert runs.independent({"slide.position": slow})["slide.position"] < 0.1 * n


def test_of_a_long_recording_blocks_count_that_begin_with_a_lead(
    rubbing: tuple[MachineData, Rig], monkeypatch: pytest.MonkeyPatch
) -> None:
    data, true = rubbing
    monkeypatch.setattr(training_runs, "LONGEST_MACHINE_FIT", 2.0)
    monkeypatch.setattr(training_runs, "LEAD", 0.25 * LEAD)
    blocks = list(training_runs._tables(data))
    assert len(blocks) == BLOCKS
    assert sum(float(block.time[-1]) - first for block, first in blocks) == pytest.approx(2.0, rel=0.1)
    assert all(first - float(block.time[0]) == pytest.approx(0.25 * LEAD, abs=2e-3) for block, first in blocks)
    found = TrainingRuns(data, kept(data), true).errors(true)
    assert found is not None and 0 < len(found["slide.position"]) < 0.7 * 2.0 / training_runs.MACHINE_ROW


def test_motion_that_somebody_led_is_not_run(rubbing: tuple[MachineData, Rig]) -> None:
    data, true = rubbing
    table = data.as_read[0]
    led = {key: 5.0 * np.sin(9.0 * table.time) if key == "slide.position" else values for key, values in table.columns.items()}
    assert TrainingRuns(replace(data, as_read=(replace(table, columns=led),)), kept(data), true).is_empty
    assert not TrainingRuns(data, kept(data), true).is_empty
