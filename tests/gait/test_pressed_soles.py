"""Soles that sink into a ground that gives."""

import numpy as np
import pytest

from exo_sim.gait import scenario
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.gait.pressed_soles import pressed
from exo_sim.gait.residual_reduction import reduced
from exo_sim.machine import ground_reaction
from exo_sim.machine.person import Person, poses_along
from exo_sim.machine.sole_contact import RADIUS, depth_under, heel_depth

PERSON = Person()


@pytest.fixture(scope="module")
def both():
    motion = reduced(scenario.motion("level_walk", PERSON, 1.0), PERSON)
    ground = ground_reaction.hold(*body_loads(Moving.of(motion), PERSON), motion.share, motion.pressure_centre, motion.support, PERSON)
    return motion, ground, pressed(motion, PERSON, ground.force, ground.centre)


def height(motion, ahead):
    """Return how high the lowest point of what touches is, ahead of the right ankle."""
    foot = poses_along(motion.position, motion.slope, PERSON)[:, ground_reaction.FEET[1]]
    low = PERSON.ankle_height - RADIUS
    return foot[:, 1] + ahead * np.sin(foot[:, 2]) - low * np.cos(foot[:, 2]) - RADIUS


def test_a_flat_foot_sinks_as_far_as_its_load_asks(both):
    _, ground, found = both
    flat = slice(110, 170)  # of the right foot's stance
    load, ahead = ground.force[flat, 1, 1], ground.centre[flat, 1]
    ball = load * (ahead - PERSON.heel) / (PERSON.toe - PERSON.heel)
    tilt = poses_along(found.position, found.slope, PERSON)[flat, ground_reaction.FEET[1], 2]
    np.testing.assert_allclose(-height(found, PERSON.heel)[flat], heel_depth(load - ball, tilt, PERSON.scale), atol=1.5e-3)
    np.testing.assert_allclose(-height(found, PERSON.toe)[flat], depth_under(ball), atol=1.5e-3)


def test_a_swinging_foot_stays_where_it_was(both):
    motion, _, found = both
    swing = slice(350, 470)
    for ahead in (PERSON.heel, PERSON.toe):
        np.testing.assert_allclose(height(found, ahead)[swing], height(motion, ahead)[swing], atol=3e-3)


def test_joints_and_pelvis_move_little(both):
    motion, _, found = both
    assert np.abs(found.position - motion.position)[:, 3:].max() < np.radians(5.0)
    assert 0.0 < (motion.position - found.position)[:, 1].max() < 0.01
    np.testing.assert_array_equal(found.position[:, [0, 2]], motion.position[:, [0, 2]])


def test_a_leg_that_is_nearly_straight_is_not_bent_for_millimetres():
    """On the treadmill's stride the knee is all but straight at heel strike and push-off; it was bent by 17 degrees."""
    motion = reduced(scenario.motion("level_walk_opensim", PERSON, 1.0), PERSON)
    ground = ground_reaction.hold(*body_loads(Moving.of(motion), PERSON), motion.share, motion.pressure_centre, motion.support, PERSON)
    found = pressed(motion, PERSON, ground.force, ground.centre)
    assert np.abs(found.position - motion.position)[:, 3:].max() < np.radians(3.0)


def test_a_cycle_of_several_strides_is_pressed_as_sharply_as_one():
    motion = reduced(scenario.motion("start_and_stop", PERSON, 1.0), PERSON)
    ground = ground_reaction.hold(*body_loads(Moving.of(motion), PERSON), motion.share, motion.pressure_centre, motion.support, PERSON)
    found = pressed(motion, PERSON, ground.force, ground.centre)
    spectrum = np.abs(np.fft.rfft((found.position - motion.position)[:, 3:], axis=0))
    assert spectrum[13:61].max() > 0.05 * spectrum[:13].max()  # beyond the harmonics of one stride
    assert spectrum[61:].max() < 1e-9 * spectrum.max()
