"""A chamber that lacks a flow shows it as the slope of its pressure error: w = V / (k R T) dp/dt."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.cylinder_runs import STEP, run_of

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.subsystems.gas.inputs import inputs
from exo_sim.diagnosis.subsystems.gas.missing_flow import missing_flow
from exo_sim.diagnosis.subsystems.gas.prediction import GasPrediction

N, K, R, T = 4000, 1.4, 287.05, 300.0


@pytest.mark.parametrize("side", [0, 1])
def test_the_slope_of_the_pressure_error_gives_back_the_flow(side: int) -> None:
    """A leak of so many grams a second and bar, put into the measured pressure by the gas law itself."""
    plant = motion_runs.plant()
    plant.world["k"], plant.world["r"] = K, R
    plant.cylinder["dead_volume_1"], plant.cylinder["dead_volume_2"] = 2e-5, 3e-5
    c = plant.cylinder[0]
    time = np.arange(N) * STEP
    length = np.full(N, 0.1)
    volume = float(c["dead_volume_1"] + c["area_1"] * 0.1 if side == 0 else c["dead_volume_2"] + c["area_2"] * (c["stroke"] - 0.1))
    flow = 2e-5 * np.sin(1.5 * time)
    predicted = np.full((N, 2), 3e5)
    error = np.cumsum(flow * K * R * T / volume) * STEP
    measured = predicted[:, side] + error
    run = run_of(*(measured if s == side else predicted[:, s] for s in range(2)), length=length, command=np.sin(1.5 * time))
    given = inputs(run, plant.world, 1.0)
    out = GasPrediction(predicted, predicted, np.zeros(N), np.full((N, 2), T))
    found = missing_flow([(given, out)], plant, Split({}), side, "mass balance")
    assert (found.acts, found.unit) == (f"flow_{side + 1}", "kg/s")
    assert found.size == pytest.approx(2e-5 / np.sqrt(2.0), rel=0.03)
    best = found.best
    assert best is not None and best.variable in ("valve_command", "time")
    command = next(curve for curve in found.curves if curve.variable == "valve_command")
    assert command(np.array([0.5]))[0] == pytest.approx(1e-5, rel=0.1)


def test_time_that_is_held_out_does_not_count() -> None:
    plant = motion_runs.plant()
    plant.world["k"], plant.world["r"] = K, R
    level = np.full(N, 3e5)
    run = run_of(level + 5e3 * np.arange(N) * STEP, level)
    given = inputs(run, plant.world, 1.0)
    out = GasPrediction(np.stack([level, level], axis=1), np.stack([level, level], axis=1), np.zeros(N), np.full((N, 2), T))
    found = missing_flow([(given, out)], plant, Split({"recording": ((0.0, N * STEP),)}), 0, "mass balance")
    assert found.size == 0.0 and found.curves == ()
