"""Ground forces under the soles: balance, bounds, and what is left over."""

import numpy as np
import pytest

from exo_sim.machine import ground_reaction
from exo_sim.machine.person import Person, poses_along

PERSON = Person()
UPRIGHT = poses_along(np.array([[0.0, 0.879, 0, 0, 0, 0, 0, 0, 0]]), np.zeros((1, 9)), PERSON)


def stand(force, moment, share=(0.5, 0.5)):
    wrench = np.zeros((1, 7, 3))
    wrench[0, 0] = [*force, moment]
    share = np.array([share])
    ground = ground_reaction.hold(UPRIGHT, wrench, share, np.full((1, 2), 0.04), np.ones(1), PERSON)
    return wrench, ground


@pytest.mark.parametrize("share", [(0.5, 0.5), (1.0, 0.0), (0.2, 0.8)])
@pytest.mark.parametrize("moment", [0.0, 30.0, -400.0])
def test_soles_and_residual_together_hold_everything(share, moment):
    _, ground = stand((60.0, -800.0), moment, share)
    force = ground.force[0].sum(axis=0) + ground.residual[0, :2]
    np.testing.assert_allclose(force, [-60.0, 800.0], atol=1e-9)
    about = (ground.place[0, :, 0] * ground.force[0, :, 1] - ground.place[0, :, 1] * ground.force[0, :, 0]).sum()
    assert about + ground.residual[0, 2] == pytest.approx(-moment, abs=1e-6)


def test_what_no_sole_can_give_is_the_residual():
    _, small = stand((0.0, -800.0), 0.0)
    assert small.residual[0, 2] == pytest.approx(0.0, abs=1e-6) and not small.outside[0]
    _, large = stand((0.0, -800.0), -800.0 * 0.4)
    tip = PERSON.toe + 0.055
    assert large.outside[0]
    assert large.centre[0] == pytest.approx(tip)
    assert large.residual[0, 2] == pytest.approx(800.0 * (0.4 - tip))


def test_the_ground_does_not_pull():
    _, ground = stand((0.0, 300.0), 0.0)
    assert (ground.force[0, :, 1] == 0.0).all()
    assert ground.residual[0, 1] == pytest.approx(-300.0)


def test_a_tilted_foot_touches_with_its_end():
    down, up = ground_reaction.soles(np.radians([[-20.0, 20.0]]), PERSON)[0]
    assert down[0] > PERSON.toe - 0.02 and down[1] > PERSON.toe
    assert up[0] == PERSON.heel and up[1] < PERSON.heel + 0.02


def test_moments_of_the_joints_are_those_of_statics():
    wrench, ground = stand((0.0, -800.0), 0.0, (1.0, 0.0))
    moments = ground_reaction.joint_moments(UPRIGHT, wrench, ground.force, ground.place)[0]
    np.testing.assert_allclose(moments[:3], 0.0, atol=1e-3)  # the load is over the hip, and so is the foot's force
    np.testing.assert_allclose(moments[3:], 0.0, atol=1e-9)
