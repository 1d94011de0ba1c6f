"""What a wearer expects of his own stride."""

import numpy as np

from exo_sim.control import wearer_plan
from exo_sim.gait import scenario
from exo_sim.gait.residual_reduction import reduced
from exo_sim.machine.ground_reaction import TOES
from exo_sim.machine.person import Person

PERSON = Person()


def test_a_plan_has_moments_and_toes_that_push_off():
    plan = wearer_plan.plan(reduced(scenario.motion("level_walk", PERSON, 1.0), PERSON), PERSON)
    assert plan.torque.shape == (512, 8)
    assert 60.0 < -plan.torque[:, 5].min() < 200.0  # plantar flexion of the right ankle at push-off
    assert plan.torque[200:300, 7].min() < -5.0 and np.abs(plan.torque[380:480, 7]).max() < 6.0


def test_an_ankle_has_room_as_far_as_its_sole_reaches():
    plan = wearer_plan.plan(reduced(scenario.motion("level_walk", PERSON, 1.0), PERSON), PERSON)
    assert plan.room.shape == (512, 4) and plan.room.min() > 0.0
    weight, sole = 9.81 * PERSON.mass, PERSON.toe + TOES - PERSON.heel
    standing = plan.room[100:140, 2:]  # of the right foot, flat on the ground
    assert (standing.sum(axis=1) < 1.2 * weight * sole).all() and (standing.sum(axis=1) > 0.6 * weight * sole).all()
    assert plan.room[380:480, 2:].max() < 10.0  # in the air
