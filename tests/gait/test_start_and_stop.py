"""A walk from stance to rest: where it begins and ends, feet that stay where they stand, and a ground that can hold it."""

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait import scenario
from exo_sim.gait.motion import SAMPLES
from exo_sim.gait.moving_body import Moving, body_loads, trunk
from exo_sim.gait.residual_reduction import reduced, with_backpack
from exo_sim.machine.ground_reaction import hold, under_foot
from exo_sim.machine.person import Person, leg_points, poses_along
from exo_sim.machine.wearer_moments import backpack_wrench

PERSON = Person()
PACK = ((-0.18, 0.33), 34.0, 0.02)


@pytest.fixture(scope="module")
def motion():
    return scenario.motion("start_and_stop", PERSON, 1.0)


def speed(motion):
    return motion.slope[:, 0] / motion.period


def test_it_begins_and_ends_at_rest_and_walks_as_recorded_between(motion):
    usual = scenario.motion("level_walk", PERSON, 1.0)
    still = np.r_[0 : SAMPLES // 2, -SAMPLES // 8 : 0]
    assert np.abs(speed(motion)[still]).max() < 0.05
    assert np.abs(motion.slope[still, 2:] / motion.period).max() < np.radians(10.0)
    assert motion.advance == pytest.approx(2.5 * usual.advance)  # six steps
    assert speed(motion).max() == pytest.approx((usual.slope[:, 0] / usual.period).max(), rel=0.1)
    assert speed(motion).min() > -0.1
    middle = slice(round(2.5 * SAMPLES), round(2.6 * SAMPLES))  # right foot's phase 1.75 to 1.85
    np.testing.assert_allclose(motion.position[middle, 3:], usual.position[round(0.75 * SAMPLES) : round(0.85 * SAMPLES), 3:],
                               atol=np.radians(4.0))  # fmt: skip
    end = leg_points(motion.position[0, [2]] + motion.position[0, [3, 6]], motion.position[0, [4, 7]], motion.position[0, [5, 8]], PERSON)
    assert np.ptp(end["ankle"][:, 0]) < 1e-3 and np.abs(end["foot_angle"]).max() < np.radians(1.0)  # feet side by side and flat


def test_loaded_feet_stay_where_they_are(motion):
    n = len(motion.position)
    poses = poses_along(motion.position, motion.slope / motion.period, PERSON)
    place = under_foot(poses, motion.pressure_centre, PERSON.ankle_height) + poses[:, :1, :2]
    steady = motion.advance * np.arange(n) / n
    for foot in range(2):
        carries = motion.share[:, foot] > 0.6
        height = place[carries, foot, 1]
        assert np.abs(height).max() < 0.02
        ankle = poses[:, (3, 6)[foot], 0] + steady
        flat = carries & motion.contact[:, 2 * foot] & motion.contact[:, 2 * foot + 1]
        rate = np.gradient(ankle, motion.period / n)[flat]
        assert np.abs(rate).max() < 0.12
    np.testing.assert_allclose(motion.share.sum(axis=1), 1.0)
    assert (motion.share[0] == 0.5).all() and motion.contact[0].all()


@pytest.mark.parametrize("carried", [0.0, 34.0])
def test_soles_on_the_ground_hold_it(motion, carried):
    place, _, inertia = PACK
    moved = with_backpack(motion, PERSON, place, carried, inertia) if carried else reduced(motion, PERSON)
    poses, loads = body_loads(Moving.of(moved), PERSON)
    if carried:
        position, acceleration = trunk(Moving.of(moved))
        loads = loads + backpack_wrench(position, acceleration, place, np.full(len(position), carried), inertia)
    ground = hold(poses, loads, moved.share, moved.pressure_centre, moved.support, PERSON)
    assert np.abs(ground.residual).max(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=5.0)  # of 25 N, 25 N, 75 N m
    up = ground.force[:, :, 1]
    assert up.min() >= 0.0 and up.sum(axis=1).max() < 1.5 * 9.81 * (PERSON.mass + carried)
    assert moved.position[:, [4, 7]].max() < np.radians(-2.0)  # no knee is overstretched
    # reduction moves neither feet nor path much
    ankles = [poses_along(it.position, np.zeros_like(it.position), PERSON)[:, (3, 6), 0] for it in (motion, moved)]
    assert np.abs(ankles[0] - ankles[1]).max() < 0.05


def test_speeds_and_slopes_are_for_strides_that_come_again():
    with pytest.raises(ScenarioError, match="begins and ends at rest; write a factor"):
        scenario.motion("start_and_stop", PERSON, "1.3 m/s")
    assert scenario.motion("start_and_stop", PERSON, 1.1).period == pytest.approx(5 * scenario.motion("level_walk", PERSON, 1.1).period)
