"""What a wearer expects of his own stride."""

import numpy as np

from exo_sim.control import wearer_plan
from exo_sim.gait import scenario
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.gait.residual_reduction import reduced
from exo_sim.machine.ground_reaction import FEET, TOES
from exo_sim.machine.person import Person
from exo_sim.machine.wearer_body import TOE_STIFFNESS

PERSON = Person()


def test_a_plan_has_moments_and_toes_that_push_off():
    motion = reduced(scenario.motion("level_walk", PERSON, 1.0), PERSON)
    plan = wearer_plan.plan(motion, PERSON)
    assert plan.torque.shape == (512, 8)
    assert 60.0 < -plan.torque[:, 5].min() < 200.0  # plantar flexion of the right ankle at push-off
    pitch = body_loads(Moving.of(motion), PERSON)[0][:, FEET, 2][:, 1]
    along_the_ground = TOE_STIFFNESS * np.clip(np.radians(5.0) - pitch, 0.0, 1.2)  # holds them bent, against their own spring
    pushed = plan.torque[:, 7] - along_the_ground
    assert pushed[200:300].min() < -20.0 and np.abs(pushed[380:480]).max() < 1e-9  # in the air nothing presses on them


def test_an_ankle_has_room_as_far_as_its_sole_reaches():
    plan = wearer_plan.plan(reduced(scenario.motion("level_walk", PERSON, 1.0), PERSON), PERSON)
    assert plan.room.shape == (512, 4) and plan.room.min() > 0.0
    weight, sole = 9.81 * PERSON.mass, PERSON.toe + TOES - PERSON.heel
    standing = plan.room[100:140, 2:]  # of the right foot, flat on the ground
    assert (standing.sum(axis=1) < 1.2 * weight * sole).all() and (standing.sum(axis=1) > 0.6 * weight * sole).all()
    assert plan.room[380:480, 2:].max() < 10.0  # in the air
