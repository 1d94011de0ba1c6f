"""How warm the gas is where a recording begins is a nuisance parameter wherever the machine was just at work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.warm_vessel import N, recorded, vessel

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.subsystems.gas.initial_temperature import begins_quietly, initial_temperatures
from exo_sim.diagnosis.subsystems.gas.model import GasModel


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
