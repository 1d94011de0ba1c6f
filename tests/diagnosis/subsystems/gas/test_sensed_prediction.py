"""What sensors show of a gas: their errors on the way out, and on the way in where a prediction begins with what they showed."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.cylinder_runs import STEP, run_of
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs, inputs
from exo_sim.diagnosis.subsystems.gas.sensed_prediction import sensed
from exo_sim.physics.plant_records import CYLINDER, WORLD

N = 800


def world() -> NDArray[np.void]:
    one = np.zeros(1, WORLD)
    one["k"], one["r"], one["atmosphere"], one["ambient"] = 1.4, 287.05, 101325.0, 293.15
    one["supply_pressure"], one["supply_temperature"], one["exhaust_pressure"] = 7e5, 293.15, 101325.0
    return one


def plant(**sensors: float) -> PlantParameters:
    cylinder = np.zeros(1, CYLINDER)
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"] = 8e-4, 7e-4, 0.2
    cylinder["dead_volume_1"] = cylinder["dead_volume_2"] = 2e-5
    return PlantParameters(world(), cylinder, {name.replace("__", "."): value for name, value in sensors.items()})


def given(level: float = 3e5) -> GasInputs:
    """Return a closed cylinder whose piston goes to and fro, one window long; its sensors begin at a level [Pa]."""
    time, pressure = np.arange(N) * STEP, np.full(N, level)
    return inputs(run_of(pressure, pressure, length=0.1 + 0.03 * np.sin(9.0 * time)), world(), 10.0)


def test_sensors_without_errors_show_the_gas() -> None:
    shown = sensed(given(), plant()).pressure
    volume = 2e-5 + 8e-4 * given().length
    np.testing.assert_allclose(shown[:, 0], 3e5 * (volume[0] / volume) ** 1.4, rtol=2e-3)


def test_a_zero_is_taken_off_what_a_prediction_begins_with_and_put_on_what_it_shows() -> None:
    """A sensor that shows 3 bar and 10 kPa too much: the gas begins at 3 bar."""
    shown = sensed(given(3e5 + 1e4), plant(pressure_1__bias=1e4, pressure_2__bias=1e4)).pressure
    np.testing.assert_allclose(shown, sensed(given(), plant()).pressure + 1e4, rtol=1e-9)


def test_a_gain_works_both_ways_as_well() -> None:
    shown = sensed(given(1.02 * 3e5), plant(pressure_1__scale=1.02, pressure_2__scale=1.02)).pressure
    np.testing.assert_allclose(shown, 1.02 * sensed(given(), plant()).pressure, rtol=1e-9)


def test_a_position_sensor_s_gain_is_taken_off() -> None:
    near, right = sensed(given(), plant(position__scale=1.1)).pressure, sensed(given(), plant()).pressure
    assert np.ptp(near[:, 0]) < np.ptp(right[:, 0])


def test_a_late_sensor_shows_it_later() -> None:
    late = 30
    shown, prompt = sensed(given(), plant(pressure_1__delay=late * STEP)).pressure, sensed(given(), plant()).pressure
    np.testing.assert_allclose(shown[2 * late :, 0], prompt[late:-late, 0], rtol=2e-2)
    assert shown[:, 1] == pytest.approx(prompt[:, 1], rel=1e-9)


def test_nothing_but_pressures_is_left_where_no_more_is_asked_for() -> None:
    assert sensed(given(), plant(), whole=False).drawn.size == 0
