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
