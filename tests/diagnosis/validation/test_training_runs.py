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
from exo_sim.diagnosis.policy.budgets import LEAD, LONGEST_MACHINE_FIT
from exo_sim.diagnosis.validation import training_runs
from exo_sim.diagnosis.validation.training_runs import TrainingRuns
from exo_sim.recording.table import Recording
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
    assert whole["slide.position"] > 3.0 * two["slide.position"]


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


@pytest.mark.parametrize(("recordings", "seconds"), [(3, 20.0), (3, 30.0), (10, 12.0), (1, 61.0), (20, 30.0), (40, 60.0)])
def test_no_more_is_run_than_may_be_and_most_of_it_counts(rubbing: tuple[MachineData, Rig], recordings: int, seconds: float) -> None:
    """Blocks lie in training time; one that does not begin with its recording has a lead, which is run as well."""
    data, _ = rubbing
    time = np.arange(0.0, seconds, 0.01)
    tables = tuple(Recording(f"{i}", time, {"slide.position": np.sin(time)}, {"slide.position": "m"}) for i in range(recordings))
    split = Split({table.name: ((0.7 * seconds, seconds),) for table in tables})
    parts = list(training_runs._parts(replace(data, as_read=tables), split))
    run, counted = sum(part.duration for part, _ in parts), sum(float(part.time[-1]) - first for part, first in parts)
    assert run <= min(LONGEST_MACHINE_FIT, 0.7 * recordings * seconds) + 1.0
    assert counted > 0.5 * min(0.7 * recordings * seconds, LONGEST_MACHINE_FIT)
    assert all(part.time[-1] <= 0.7 * seconds for part, _ in parts)
    leads = [first - float(part.time[0]) for part, first in parts]
    assert all(lead == pytest.approx(LEAD if part.time[0] > 0.0 else 0.0, abs=0.02) for lead, (part, _) in zip(leads, parts, strict=True))


def test_a_column_without_noise_does_not_count(rubbing: tuple[MachineData, Rig], monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors in units of nothing are infinite, and no number would move."""
    data, true = rubbing
    quiet = float(data.as_read[0]["piston.pressure_2"][0])
    monkeypatch.setattr(training_runs, "shown_noise", lambda noise, values, computed: 0.0 if values[0] == quiet else noise)
    found = TrainingRuns(data, kept(data), true).errors(true)
    assert found is not None and set(found) == {"piston.pressure_1", "slide.position"}


def test_motion_that_somebody_led_is_not_run(rubbing: tuple[MachineData, Rig]) -> None:
    data, true = rubbing
    table = data.as_read[0]
    led = {key: 5.0 * np.sin(9.0 * table.time) if key == "slide.position" else values for key, values in table.columns.items()}
    assert TrainingRuns(replace(data, as_read=(replace(table, columns=led),)), kept(data), true).is_empty
    assert not TrainingRuns(data, kept(data), true).is_empty
