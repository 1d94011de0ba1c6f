"""Commands are read as samples where that predicts better, and not because it expects less; each recording by itself."""

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
from exo_sim.diagnosis.pipeline.command_reading import as_sampled, read_as_sampled
from exo_sim.diagnosis.policy.recordings import HELD_IN_THE_END
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.rig import assembly

N, EVERY = 12000, 5


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> PlantParameters:
    rig = benches.bench(tmp_path_factory.mktemp("read"))
    return PlantParameters(assembly.world(rig), assembly.cylinders(rig))


def with_dead_volume(plant: PlantParameters, times: float) -> PlantParameters:
    other = plant.copy()
    other.cylinder["dead_volume_1"] *= times
    return other


def logged(true: PlantParameters, name: str, held: bool) -> CylinderRun:
    """Return a recording at 200 Hz, of a loop as slow as its logger or of one of 1 kHz."""
    rng = np.random.default_rng(4)
    time = np.arange(N) * 1e-3
    command = 0.15 * np.sin(9.0 * time) + np.convolve(rng.normal(0.0, 0.06, N), np.ones(30) / 6.0, "same")
    if held:
        command = np.repeat(command[::EVERY], EVERY)
    length = float(true.cylinder["stroke"][0]) * (0.5 + 0.3 * np.sin(5.0 * time))
    run = run_of(
        np.full(N, 3e5), np.full(N, 3e5), time=time, command=command, length=length, speed=np.gradient(length, time), commanded=True,
        noise=(60.0, 60.0),
    )  # fmt: skip
    pressure = GasModel([run], true, Split({}), window=math.inf).predict(true, 0).pressure + rng.normal(0.0, 60.0, (N, 2))
    return replace(run, recording=name, pressure=(pressure[:, 0], pressure[:, 1])).at(np.arange(0, N, EVERY), (0,))


@pytest.mark.parametrize("times", [1.02, 1.05, 3.0])
def test_held_commands_stay_held_beside_an_error_that_has_no_name(plant: PlantParameters, times: float) -> None:
    model = GasModel([logged(with_dead_volume(plant, times), "held", True)], plant, Split({}))
    assert float(np.mean(model.residual_of(plant) ** 2)) > 5.0
    assert read_as_sampled(model, Split({}), {}, (), HELD_IN_THE_END, True) is model


def test_samples_are_known_beside_an_error_that_has_no_name(plant: PlantParameters) -> None:
    model = GasModel([logged(with_dead_volume(plant, 1.05), "samples", False)], plant, Split({}))
    assert all(run.sampled for run in read_as_sampled(model, Split({}), {}, (), HELD_IN_THE_END, True).all_runs)


def test_each_recording_is_read_by_itself(plant: PlantParameters) -> None:
    model = GasModel([logged(plant, "held", True), logged(plant, "samples", False)], plant, Split({}))
    found = read_as_sampled(model, Split({}), {}, (), HELD_IN_THE_END)
    assert [run.sampled for run in found.all_runs] == [False, True] and found.effort is model.effort
    assert read_as_sampled(found, Split({}), {}, (), HELD_IN_THE_END) is found
    assert [run.sampled for run in as_sampled(model, Split({}), {"samples"}).all_runs] == [False, True]
    assert as_sampled(model, Split({}), ()) is model
