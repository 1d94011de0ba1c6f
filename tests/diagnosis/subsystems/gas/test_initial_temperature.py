"""How warm the gas is where a recording begins is a nuisance parameter wherever the machine was just at work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.cylinder_runs import run_of

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.gas.initial_temperature import begins_quietly, initial_temperatures
from exo_sim.diagnosis.subsystems.gas.inputs import inputs
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.gas.prediction import run_gas
from exo_sim.physics.plant_records import CYLINDER, WORLD

PERIOD, N, NOISE = 2e-3, 3000, 100.0
RNG = np.random.default_rng(7)


def vessel() -> PlantParameters:
    world, cylinder = np.zeros(1, WORLD), np.zeros(1, CYLINDER)
    world["k"], world["r"], world["atmosphere"], world["ambient"] = 1.4, 287.05, 101325.0, 293.15
    world["supply_pressure"], world["supply_temperature"], world["exhaust_pressure"] = 7e5, 293.15, 101325.0
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"], cylinder["valve_area"] = 2e-3, 1.8e-3, 0.2, 2e-6
    cylinder["dead_volume_1"] = cylinder["dead_volume_2"] = 2e-5
    cylinder["wall_heat_transfer"]["conductance"] = 0.4
    return PlantParameters(world, cylinder)


def recorded(warmth: tuple[float, float]) -> CylinderRun:
    """Two chambers at rest with the valve shut, then a short fill and vent; the gas not as warm as the room at first."""
    plant, time = vessel(), np.arange(N) * PERIOD
    command = np.where((time > 3.0) & (time < 3.3), 0.3, 0.0)
    start = run_of(np.full(N, 5e5), np.full(N, 3e5), time=time, length=np.full(N, 0.1), command=command, commanded=True)
    predicted = run_gas(inputs(start, plant.world, 100.0), plant.world, plant.cylinder, warmth=warmth).pressure
    noisy = predicted + NOISE * RNG.normal(size=predicted.shape)
    return replace(start, pressure=(noisy[:, 0], noisy[:, 1]), noise=(NOISE, NOISE))


def test_gas_of_the_room_s_temperature_is_asked_nothing() -> None:
    run = recorded((0.0, 0.0))
    assert begins_quietly(run)
    assert initial_temperatures([run]) == ()


@pytest.mark.parametrize("warmth", [(25.0, 0.0), (0.0, -20.0)])
def test_gas_that_settles_at_first_is(warmth: tuple[float, float]) -> None:
    run = recorded(warmth)
    assert not begins_quietly(run)
    assert len(initial_temperatures([run])) == 2
    one_sensor = replace(run, pressure=(run.pressure[0], None))
    assert len(initial_temperatures([one_sensor])) == (1 if warmth[0] else 0)


def test_a_piston_that_moves_at_first_warms_its_gas() -> None:
    run = recorded((0.0, 0.0))
    assert not begins_quietly(replace(run, length=0.1 + 0.01 * run.time))


def test_gas_that_was_held_before_the_run_begins_is_asked_nothing() -> None:
    """A print that leaks, held for 7 s and judged from its fall on: with its gas free by 30 K the leak's interval held nil."""
    run = replace(recorded((25.0, 0.0)), settled=True)
    assert begins_quietly(run) and initial_temperatures([run]) == ()


def test_a_recording_of_a_few_samples_is_not_taken_to_begin_quietly() -> None:
    assert not begins_quietly(recorded((0.0, 0.0)).until(8))


def test_the_temperature_of_the_gas_at_first_is_found_and_what_it_does_explained() -> None:
    warmth = (25.0, -15.0)
    run, plant = recorded(warmth), vessel()
    model = GasModel([run], plant, Split({}))
    free = initial_temperatures(model.all_runs)
    found = fit(model.residual, free, {q: q.start for q in free})
    np.testing.assert_allclose([found.values[q] for q in free], warmth, atol=1.0)
    assert found.sse / model.size < 1.3 < np.mean(model.residual({}) ** 2)


def test_a_part_that_begins_later_is_not_given_the_temperature_of_the_start() -> None:
    run, plant = recorded((25.0, -15.0)), vessel()
    free = initial_temperatures([run])
    warm = plant.with_values([(q, 25.0) for q in free])
    later = GasModel([run.part(500, N)], plant, Split({}))
    np.testing.assert_array_equal(later.residual_of(warm), later.residual_of(plant))
    whole = GasModel([run], plant, Split({}))
    assert not np.array_equal(whole.residual_of(warm), whole.residual_of(plant))
