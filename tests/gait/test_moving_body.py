"""A motion by time, and the loads of a body that moves by it."""

import numpy as np

from exo_sim.gait import scenario
from exo_sim.gait.moving_body import Moving, body_loads, trunk
from exo_sim.machine.anthropometry import GRAVITY
from exo_sim.machine.person import Person

PERSON = Person(1.75, 75.0)
WALK = scenario.motion("level_walk", PERSON, 1.0)


def test_rates_are_those_of_the_places() -> None:
    along, step = Moving.of(WALK), WALK.period / len(WALK.position)
    for low, high in ((along.position, along.rate), (along.rate, along.acceleration)):
        mean = 0.5 * (high[1:] + high[:-1])
        steady = np.array([WALK.advance / WALK.period, WALK.climb / WALK.period, *[0.0] * 7]) if low is along.position else 0.0
        np.testing.assert_allclose(np.diff(low, axis=0) / step + steady, mean, atol=2e-3 * np.abs(high).max())


def test_some_samples_are_those_of_all() -> None:
    for some, every in zip(Moving.of(WALK, slice(3, None, 8)), Moving.of(WALK), strict=True):
        np.testing.assert_array_equal(some, every[3::8])


def test_over_a_cycle_the_loads_are_the_weight() -> None:
    """What comes again after a cycle is as fast as it was: the mean of the inertial forces is nothing."""
    _, wrench = body_loads(Moving.of(WALK), PERSON)
    up = wrench[:, :, :2].sum(axis=1).mean(axis=0)
    np.testing.assert_allclose(up, [0.0, -PERSON.mass * GRAVITY], atol=0.02 * PERSON.mass * GRAVITY)


def test_the_trunk_is_the_first_three_coordinates() -> None:
    position, acceleration = trunk(Moving.of(WALK))
    np.testing.assert_array_equal(position[:, :3], WALK.position[:, :3])
    np.testing.assert_allclose(position[:, 3:], WALK.slope[:, :3] / WALK.period, rtol=1e-12)
    np.testing.assert_allclose(acceleration, WALK.curvature[:, :3] / WALK.period**2, rtol=1e-12)
