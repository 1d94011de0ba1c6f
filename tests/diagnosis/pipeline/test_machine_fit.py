"""Numbers of an improved rig, fitted together to the whole machine."""

from __future__ import annotations

import json
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.outcome.rig_numbers import open_numbers
from exo_sim.diagnosis.outcome.rig_update import Part, Rank, RigUpdate
from exo_sim.diagnosis.pipeline.machine_fit import Linearised, cost, fitted_to_machine, weighed_step
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.validation.training_runs import Errors, TrainingRuns, _Stretch
from exo_sim.recording.table import Recording
from exo_sim.rig import Correction, EffectEntry, EffectSetting
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory: pytest.TempPathFactory) -> tuple[MachineData, float]:
    """A bench with hidden dry friction, and how large that is [N]."""
    folder: Path = tmp_path_factory.mktemp("rubbing")
    write_case(make_case("a", ("coulomb_friction",), 11, 0.5, Conditions(duration=10.0, known=())), folder, "parquet", open_truth=True)
    hidden = json.loads((folder / "truth.json").read_text())["hidden"]
    force = float(next(iter(hidden[0]["parameters"].values()))["value"])
    return gather([folder / "recording.parquet"], folder / "rig.toml"), force


def kept(data: MachineData) -> Split:
    return Split({data.recordings[0].name: ((7.0, 10.0),)})


def found(data: MachineData, force: float, reach: float) -> RigUpdate:
    """Return dry friction that is known to so many newtons, a load that is known to a tenth, and a dead volume that is known well."""
    setting = EffectSetting("coulomb_friction", "piston", {"force": force})
    mass = float(data.model.body("carriage").mass[0])
    load = Correction(("bodies", "carriage", "mass"), mass, "kg", (0.9 * mass, 1.1 * mass), mass)
    friction = EffectEntry(setting, {"force": (force - reach, force + reach)})
    volume = data.rig.cylinders["piston"].dead_volume_1
    dead = Correction(("cylinders", "piston", "dead_volume_1"), volume, "m^3", (0.998 * volume, 1.002 * volume))
    gas = Part("gas of piston", Rank.REFITTED, (), (dead,))
    return RigUpdate(data.rig, (Part("motion of slide", Rank.FOUND, (friction,), (load,)), gas))


def test_where_only_one_side_is_open_its_numbers_do_not_make_up_for_the_other(rubbing: tuple[MachineData, float]) -> None:
    """Volumes of a bench moved to the ends of their intervals, for its friction."""
    data, force = rubbing
    both = found(data, 0.85 * force, 0.5 * force)
    for part in both.parts:
        alone = RigUpdate(data.rig, (part,))
        assert fitted_to_machine(data, alone, kept(data)) is alone
    assert fitted_to_machine(data, both, kept(data)) is not both


def force_of(update: RigUpdate) -> float:
    return next(number.value for number in open_numbers(update) if number.place[-1] == "force")


@pytest.mark.parametrize("off", [0.85, 1.15])
def test_a_number_that_is_off_within_its_interval_comes_close_to_the_truth(rubbing: tuple[MachineData, float], off: float) -> None:
    data, force = rubbing
    fitted = fitted_to_machine(data, found(data, off * force, 0.5 * force), kept(data))
    assert abs(force_of(fitted) - force) < 0.4 * abs(off - 1.0) * force
    mass = float(data.model.body("carriage").mass[0])
    assert next(n.value for n in open_numbers(fitted) if n.place[-1] == "mass") == pytest.approx(mass, rel=0.01)


def test_no_number_leaves_its_interval(rubbing: tuple[MachineData, float]) -> None:
    data, force = rubbing
    fitted = fitted_to_machine(data, found(data, 0.5 * force, 0.1 * force), kept(data))
    assert force_of(fitted) == pytest.approx(0.6 * force, rel=1e-9)


def test_numbers_that_are_true_stay_about_where_they_are(rubbing: tuple[MachineData, float]) -> None:
    data, force = rubbing
    assert force_of(fitted_to_machine(data, found(data, force, 0.2 * force), kept(data))) == pytest.approx(force, rel=0.03)


def test_nothing_is_fitted_where_nothing_is_open_or_the_time_is_up(rubbing: tuple[MachineData, float]) -> None:
    data, force = rubbing
    friction = EffectEntry(EffectSetting("coulomb_friction", "piston", {"force": force}))
    sure = RigUpdate(data.rig, (Part("motion of slide", Rank.FOUND, (friction,)),))
    assert fitted_to_machine(data, sure, kept(data)) is sure
    update = found(data, 0.8 * force, 0.5 * force)
    assert fitted_to_machine(data, update, kept(data), is_spent=lambda: True) is update


def test_a_rig_that_is_no_machine_is_left_as_it_is(rubbing: tuple[MachineData, float]) -> None:
    """Why it is refused is said where it is put to the test."""
    data, force = rubbing
    both = EffectSetting("asymmetric_friction", "piston", {"forward": force, "backward": force})
    richer = Part("gas of piston", Rank.FOUND, (EffectEntry(both, {"forward": (0.0, 2.0 * force)}),))
    refused = RigUpdate(data.rig, (*found(data, force, 1.0).parts, richer))
    assert fitted_to_machine(data, refused, kept(data)) is refused


class Windows:
    """Runs of three windows whose columns are held against nothing but themselves."""

    independent = TrainingRuns.independent

    def __init__(self, rows: int, columns: tuple[str, ...]) -> None:
        time = np.arange(rows, dtype=np.float64) * 0.01
        counted = dict.fromkeys(columns, np.ones(rows, dtype=bool))
        self._stretches = [_Stretch(Recording("x", time, {}, {}), {}, counted, dict.fromkeys(columns, 1.0))]


def line(rng: np.random.Generator, numbers: int, truth: np.ndarray, drift: float, columns: tuple[str, ...] = ("a", "b")) -> Linearised:
    """Return three windows of 2 s in which a step of smooth responses, and a drift that no number explains, add to noise of one."""
    time = np.arange(600) * 0.01
    within = time % 2.0
    responses, errors = {}, Errors()
    for column in columns:
        shapes = [within * np.sin((0.7 + 0.4 * j) * time + rng.uniform(0.0, 6.0)) for j in range(numbers)]
        responses[column] = 20.0 * np.stack(shapes, axis=1)
        astray = drift * within * rng.standard_normal(3)[(time // 2.0).astype(int)]
        errors[column] = astray + rng.standard_normal(600) - responses[column] @ truth
    return Linearised(errors, responses)


def moved_by(one: Linearised, numbers: int) -> np.ndarray:
    ends = np.tile([-2.0, 2.0], (numbers, 1))
    return weighed_step(one, ends, cast(TrainingRuns, Windows(600, tuple(one.errors))))[0]


def test_numbers_come_to_what_the_errors_say_of_them() -> None:
    truth = np.array([0.8, -1.1, 0.3])
    assert moved_by(line(np.random.default_rng(1), 3, truth, 0.0), 3) == pytest.approx(truth, abs=0.15)


def test_a_drift_that_no_number_explains_moves_many_numbers_by_little() -> None:
    """What fits best moves twenty numbers by far more than the two standard errors that they may: they would end at their bounds."""
    drift = line(np.random.default_rng(2), 20, np.zeros(20), 500.0)
    rows, errors = (np.concatenate(list(one.values())) for one in (drift.responses, drift.errors))
    assert np.sqrt(np.mean(np.linalg.lstsq(rows, -errors, rcond=None)[0] ** 2)) > 4.0
    assert np.sqrt(np.mean(moved_by(drift, 20) ** 2)) < 0.7


def test_a_step_that_ends_at_a_bound_takes_the_others_with_it() -> None:
    """Two numbers that do the same: what one may not move by, the other does."""
    one = line(np.random.default_rng(3), 1, np.array([1.8]), 0.0)
    twice = Linearised(one.errors, {key: np.repeat(rows, 2, axis=1) for key, rows in one.responses.items()})
    ends = np.array([[-0.2, 0.2], [-2.0, 2.0]])
    moved, weights = weighed_step(twice, ends, cast(TrainingRuns, Windows(600, ("a", "b"))))
    assert moved == pytest.approx([0.2, 1.6], abs=0.1)
    assert cost(twice.at(moved), weights, moved) < cost(twice.errors, weights, np.zeros(2))
