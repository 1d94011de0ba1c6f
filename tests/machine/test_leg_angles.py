"""The inverse of a leg's forward kinematics."""

import numpy as np

from exo_sim.machine.leg_angles import leg_to
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
