"""The inverse of a leg's forward kinematics."""

import numpy as np
import pytest

from exo_sim.machine.leg_angles import held_back, leg_to
from exo_sim.machine.person import Person, leg_points


def test_the_leg_goes_where_its_ankle_is_wanted():
    person, chance = Person(1.8), np.random.default_rng(3)
    thigh, knee, ankle = chance.uniform(-0.5, 1.0, 40), chance.uniform(-1.9, -0.1, 40), chance.uniform(-0.4, 0.4, 40)
    pitch = chance.uniform(-0.3, 0.1, 40)
    point = leg_points(thigh, knee, ankle, person)
    found = leg_to(point["ankle"], thigh + knee + ankle, pitch, person)
    np.testing.assert_allclose(found, np.stack([thigh - pitch, knee, ankle], axis=1), atol=1e-9)


def test_a_leg_out_of_reach_points_there_stretched():
    hip, knee, _ = leg_to(np.array([[0.0, -2.0]]), np.zeros(1), np.zeros(1), Person())[0]
    assert abs(hip) < 0.06 and -0.1 < knee <= 0.0


def test_a_knee_that_overextends_for_a_while_comes_back_without_a_jerk():
    """Cut off at its shortest the leg would turn its knee at once where it comes back: an infinite acceleration of shank and foot."""
    person, phase = Person(), np.arange(512) / 512
    knee = np.radians(-20.0 + 21.5 * np.cos(2 * np.pi * phase))  # 1.5 degrees too far
    point = leg_points(np.zeros(512), knee, np.zeros(512), person)
    found = leg_to(point["ankle"], knee, np.zeros(512), person)[:, 1]
    assert np.abs(found - np.minimum(knee, 0.0)).max() < np.radians(4.5)
    assert found.max() < np.radians(-3.5)

    def jerkiest(angle):
        return np.abs(np.diff(np.concatenate([angle, angle[:2]]), 2)).max()

    assert jerkiest(found) < 3.0 * jerkiest(knee)


def test_a_foot_stays_where_the_hip_goes_ahead():
    person = Person()
    thigh, knee, ankle = np.radians([30.0, 10.0, -15.0]), np.radians([-12.0, -20.0, -25.0]), np.radians([5.0, 10.0, -5.0])
    ahead = np.full(3, 8e-3)
    before = leg_points(thigh, knee, ankle, person)
    hip, bend, turn = held_back(ahead, thigh, knee, person)
    after = leg_points(thigh + hip, knee + bend, ankle + turn, person)
    np.testing.assert_allclose(after["foot_angle"], before["foot_angle"], atol=1e-12)
    slid = after["ankle"] - before["ankle"] + [8e-3, 0.0]
    assert np.abs(slid).max(axis=0) == pytest.approx([0.0, 0.0], abs=2.5e-3)
    assert np.abs(slid[:, 0]).max() < 1e-3


def test_a_stretched_leg_is_not_bent_for_a_foot_that_stays():
    hip, bend, _ = held_back(np.array([8e-3]), np.zeros(1), np.zeros(1), Person())
    assert np.abs([hip, bend]).max() < np.radians(3.0)
