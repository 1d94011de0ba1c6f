"""Walks at other speeds and on slopes: the law of stride length, feet on the ground, joints as measured ones change."""

import numpy as np
import pytest

from exo_sim.errors import ScenarioError
from exo_sim.gait import scenario
from exo_sim.gait.motion import SAMPLES
from exo_sim.gait.speed_and_slope import at_speed, on_slope
from exo_sim.machine.person import Person

PERSON = Person()


@pytest.fixture(scope="module")
def level():
    return scenario.motion("level_walk", PERSON, 1.0)


def knee_at_strike(motion):
    return np.degrees(motion.position[0, 7])


def test_stride_and_cadence_go_with_powers_of_speed(level):
    for factor in (0.6, 0.8, 1.3):
        other = at_speed(level, PERSON, factor)
        assert other.advance / other.period == pytest.approx(factor * level.advance / level.period)
        assert level.period / other.period == pytest.approx(factor**0.58)  # Grieve and Gear 1966
    np.testing.assert_allclose(at_speed(level, PERSON, 1.0).position, level.position, atol=1e-9)
    with pytest.raises(ScenarioError, match=r"write 0\.60 to 1\.80 m/s"):
        at_speed(level, PERSON, 2.0)


def test_hips_swing_farther_the_faster(level):
    swings = [np.ptp(at_speed(level, PERSON, factor).position[:, 6]) for factor in (0.6, 1.0, 1.3)]
    assert swings[0] < swings[1] < swings[2]


def test_the_faster_the_more_the_pelvis_rises_and_the_less_of_the_stride_a_foot_stands(level):
    """Orendurff and others 2004; Kirtley, Whittle and Jefferson 1985."""
    pace, rises, stands = level.advance / level.period, np.ptp(level.position[:, 1]), np.mean(level.share > 0.0)
    for factor in (0.6, 0.8, 1.3):
        other = at_speed(level, PERSON, factor)
        assert np.ptp(other.position[:, 1]) == pytest.approx(factor**0.69 * rises, rel=1e-3)
        assert np.mean(other.share > 0.0) == pytest.approx(stands - 0.035 * (factor - 1.0) * pace, abs=2.5 / SAMPLES)
        np.testing.assert_allclose(other.share.sum(axis=1), 1.0)


def test_uphill_the_leading_leg_is_bent_and_downhill_the_standing_one(level):
    """Lay, Hass and Gregor 2006: hip and knee are more flexed at strike uphill; downhill the knee of the standing leg."""
    up, down = on_slope(level, PERSON, 0.10), on_slope(level, PERSON, -0.10)
    assert knee_at_strike(up) < knee_at_strike(level) - 15.0
    assert up.position[0, 6] > level.position[0, 6] + np.radians(10.0)
    standing = slice(200, 260)  # late stance of the right leg
    assert down.position[standing, 7].mean() < level.position[standing, 7].mean() - np.radians(10.0)
    assert up.climb == pytest.approx(0.10 * up.advance)
    assert np.hypot(up.advance, up.climb) == pytest.approx(level.advance)
    np.testing.assert_allclose(on_slope(level, PERSON, 0.0).position, level.position, atol=1e-9)
    with pytest.raises(ScenarioError, match=r"write -0\.15 to 0\.15"):
        on_slope(level, PERSON, 0.3)
