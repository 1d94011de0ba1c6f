"""Stairs: feet on their treads, one a step, clear of the edges in between, and a body that its feet can hold."""

import dataclasses

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.gait.residual_reduction import reduced
from exo_sim.gait.stairs import DOWN, UP, walking_stairs
from exo_sim.machine.ground_reaction import totals
from exo_sim.machine.person import Person, leg_points

PERSON = Person()


@pytest.mark.parametrize("stairs", [UP, DOWN])
def test_no_foot_goes_through_a_tread(stairs):
    motion = walking_stairs(stairs, PERSON)
    gone = np.arange(len(motion.position)) / len(motion.position)
    for first in (3, 6):
        angles = motion.position[:, first : first + 3]
        point = leg_points(motion.position[:, 2] + angles[:, 0], angles[:, 1], angles[:, 2], PERSON)
        for tip in ("heel", "toe"):
            x = point[tip][:, 0] + motion.position[:, 0] + motion.advance * gone
            z = point[tip][:, 1] + motion.position[:, 1] + motion.climb * gone
            assert min(z - [motion.ground.height(place) for place in x]) > -3e-3


@pytest.mark.parametrize("stairs", [UP, DOWN])
def test_two_treads_a_cycle_and_always_some_weight_on_the_feet(stairs):
    motion = walking_stairs(stairs, PERSON)
    assert (motion.advance, motion.climb) == pytest.approx((2 * stairs.tread, 2 * stairs.rise))
    half = len(motion.position) // 2  # left and right are alike, half a cycle apart
    np.testing.assert_allclose(np.roll(motion.position[:, 3:6], half, axis=0), motion.position[:, 6:9], atol=1e-9)
    moved = reduced(motion, PERSON)
    weight = -totals(*body_loads(Moving.of(moved), PERSON))[:, 1]
    assert weight.min() > 0.2 * 9.81 * PERSON.mass
    assert abs(np.degrees(moved.position[:, 2]).mean()) < 25.0
    assert np.degrees(moved.position[:, [4, 7]]).min() > -112.0


def test_stairs_that_nobody_builds_are_refused():
    with pytest.raises(ScenarioError, match="which a foot fits"):
        walking_stairs(dataclasses.replace(UP, tread=0.1), PERSON)
    with pytest.raises(ScenarioError, match=r"rise = 0\.4 m"):
        walking_stairs(dataclasses.replace(UP, rise=0.4), PERSON)
