"""A bench whose recording is thinned: predictions from what is left miss by what is said, and rows are weighed by it."""

from __future__ import annotations

import math
from dataclasses import replace

import benches
import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.pipeline.command_reading import read_as_sampled
from exo_sim.diagnosis.policy.recordings import HELD_IN_THE_END
from exo_sim.diagnosis.subsystems.gas.inputs import inputs
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.sampling_error import _mean_about, sampling_error
from exo_sim.rig import assembly

N, FINE = 12000, 1e-3


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> PlantParameters:
    rig = benches.bench(tmp_path_factory.mktemp("sampled"))
    return PlantParameters(assembly.world(rig), assembly.cylinders(rig))


@pytest.fixture(scope="module")
def fine(plant: PlantParameters) -> CylinderRun:
    """A valve that is told something else each millisecond, and the pressures that follow."""
    rng = np.random.default_rng(4)
    time = np.arange(N) * FINE
    command = 0.15 * np.sin(9.0 * time) + np.convolve(rng.normal(0.0, 0.06, N), np.ones(30) / 6.0, "same")
    travel = float(plant.cylinder["stroke"][0])
    length = travel * (0.5 + 0.3 * np.sin(5.0 * time))
    start = np.full(N, 3e5)
    run = run_of(
        start, start, time=time, command=command, length=length, speed=np.gradient(length, time), commanded=True, noise=(60.0, 60.0)
    )  # fmt: skip
    pressure = GasModel([run], plant, Split({}), window=math.inf).predict(plant, 0).pressure
    noise = rng.normal(0.0, 60.0, pressure.shape)
    return replace(run, pressure=(pressure[:, 0] + noise[:, 0], pressure[:, 1] + noise[:, 1]))


def thinned(run: CylinderRun, every: int, sampled: bool = False) -> CylinderRun:
    return replace(run.at(np.arange(0, N, every), (0,)), sampled=sampled)


@pytest.mark.parametrize("every", [5, 10, 20])
def test_predictions_from_every_few_samples_miss_by_what_is_said(plant: PlantParameters, fine: CylinderRun, every: int) -> None:
    model = GasModel([thinned(fine, every, sampled=True)], plant, Split({}))
    (errors,), (said,) = model.errors(plant), model._set.unsampled
    left = float(np.sqrt(np.mean(errors**2) / np.mean(said**2)))
    assert 0.3 < left < 1.6
    assert float(np.sqrt(np.mean(model.residual_of(plant) ** 2))) < 1.8
    held = GasModel([thinned(fine, every)], plant, Split({}))
    assert float(np.sqrt(np.mean(held.residual_of(plant) ** 2))) > 5.0


def test_commands_that_are_held_leave_nothing_unknown(plant: PlantParameters, fine: CylinderRun) -> None:
    assert not sampling_error(inputs(fine, plant.world, 1.2), plant).any()
    assert not sampling_error(inputs(thinned(fine, 10), plant.world, 1.2), plant).any()


def test_a_run_shorter_than_the_span_of_the_mean_has_one_error_all_along(plant: PlantParameters, fine: CylinderRun) -> None:
    short = thinned(fine, 10, sampled=True).at(np.arange(40), (0,))
    said = sampling_error(inputs(short, plant.world, 1.2), plant)
    assert said.shape == (40, 2) and np.isfinite(said).all() and said.any()


def test_commands_are_read_as_samples_where_pressures_follow_their_means(plant: PlantParameters, fine: CylinderRun) -> None:
    for run, read in ((fine, False), (thinned(fine, 10), True)):
        model = GasModel([run], plant, Split({}))
        found = read_as_sampled(model, Split({}), {}, (), HELD_IN_THE_END)
        assert (found is not model) is read and all(one.sampled is read for one in found.all_runs)
    slow = thinned(fine, 10)
    told = GasModel([slow], plant, Split({}), window=math.inf).predict(plant, 0).pressure  # a loop as slow as its logger
    model = GasModel([replace(slow, pressure=(told[:, 0], told[:, 1]))], plant, Split({}))
    assert read_as_sampled(model, Split({}), {}, (), HELD_IN_THE_END) is model


def test_what_was_not_predicted_is_no_error_of_nothing() -> None:
    values = np.full(100, 4.0)
    values[:30] = values[60:65] = np.nan
    np.testing.assert_allclose(_mean_about(values, 10), 4.0)
    np.testing.assert_array_equal(_mean_about(np.full(9, np.nan), 3), 0.0)
