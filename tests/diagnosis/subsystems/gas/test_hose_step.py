"""Where sensors sit behind a hose a fit's steps are as long as the noise of its rows affords."""

from __future__ import annotations

import benches
import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy.recordings import STEP_ERROR
from exo_sim.diagnosis.subsystems.gas.hose_step import LONGER
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.prediction import HOSE_STEP
from exo_sim.rig import assembly

N, PERIOD = 1500, 4e-3


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> PlantParameters:
    rig = benches.bench(tmp_path_factory.mktemp("steps"))
    return PlantParameters(assembly.world(rig), assembly.cylinders(rig))


def run(plant: PlantParameters, noise: float) -> CylinderRun:
    time, level = np.arange(N) * PERIOD, np.full(N, 3e5)
    length = float(plant.cylinder["stroke"][0]) * (0.5 + 0.3 * np.sin(5.0 * time))
    command = np.where(np.sin(7.0 * time) > 0.2, 0.5, -0.3)
    return run_of(
        level, level, time=time, command=command, length=length, speed=np.gradient(length, time), commanded=True, noise=(noise, noise)
    )  # fmt: skip


def with_sensors_behind_a_hose(plant: PlantParameters) -> PlantParameters:
    hose = (plant := plant.copy()).cylinder["line_restriction"]
    hose["area"], hose["volume"], hose["sensor"] = 3.0 * plant.cylinder["valve_area"], 8e-6, 1.0
    return plant


def test_the_louder_a_recording_is_the_longer_are_its_steps(plant: PlantParameters) -> None:
    quiet, middle, loud = (GasModel([run(plant, noise)], plant, Split({}))._stepped[0].hose_step for noise in (1.0, 2e3, 1e6))
    assert quiet == HOSE_STEP and loud == LONGER[-1]
    assert quiet < middle < loud


@pytest.mark.parametrize("noise", [100.0, 1e3, 1e4])
def test_what_longer_steps_are_off_by_drowns_in_the_noise(plant: PlantParameters, noise: float) -> None:
    model = GasModel([run(plant, noise)], plant, Split({}))
    usual = GasModel([run(plant, noise)], plant, Split({}))
    usual._stepped = usual.inputs  # type: ignore[misc]
    machine = with_sensors_behind_a_hose(plant)
    shown, exact = (one._set.means(one.pressures(machine)) for one in (model, usual))
    assert rms(shown - exact) < 1.5 * STEP_ERROR


def test_what_is_reported_is_predicted_with_the_usual_steps(plant: PlantParameters) -> None:
    loud = run(plant, 1e6)
    assert GasModel([loud], plant, Split({}), on_test=True)._stepped[0].hose_step == 0.0  # the usual
