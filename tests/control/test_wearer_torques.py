"""A wearer's torques: loads by coordinate, and legs that push the pelvis."""

import numpy as np
import pytest

from exo_sim.control import wearer_torques
from exo_sim.machine.person import Person, poses_along

PERSON = Person()
DOFS = np.arange(11)


@pytest.fixture
def pose():
    rng = np.random.default_rng(5)
    q, v = rng.normal(0.0, 0.4, 9), rng.normal(0.0, 1.0, 9)
    return q, v, poses_along(q[None], v[None], PERSON)[0]


def test_loads_on_segments_do_the_same_work_at_the_coordinates(pose):
    _, v, poses = pose
    it = wearer_torques.mover(PERSON, torque=np.zeros((4, 8)), dofs=DOFS)
    wrench, applied = np.random.default_rng(6).normal(0.0, 100.0, (7, 3)), np.zeros(11)
    wearer_torques.apply(poses, wrench, applied, it)
    assert applied[:9] @ v == pytest.approx((wrench * poses[:, 3:]).sum())
    assert (applied[9:] == 0.0).all()


def test_legs_push_the_pelvis_where_it_should_be(pose):
    q, _, poses = pose
    it = wearer_torques.mover(PERSON, torque=np.zeros((4, 8)), dofs=DOFS)
    off = np.array([0.02, -0.01, 0.05])
    wanted = q.copy()
    wanted[:3] += off
    position, slope = np.tile(wanted, (5, 1)), np.zeros((5, 9))
    share = np.tile([1.0, 0.0], (5, 1))
    it.placement[:] = 0.0
    wearer_torques.ask(0.3, 1.0, 0.0, 0.0, position, slope, share, q, np.zeros(9), poses, PERSON.lengths(), it)
    push = it.pelvis_stiffness * off
    np.testing.assert_allclose(it.applied[:3], it.held_stiffness * off)
    # a massless left leg whose foot is fixed: moving the pelvis, its joints do the work of the push
    np.testing.assert_allclose(it.applied[6:9], 0.0, atol=1e-9)
    for move in np.eye(3):
        rates = _with_foot_fixed(q, move)
        assert it.applied[3:6] @ rates == pytest.approx(push @ move, abs=1e-6)


def test_a_leg_pushes_ahead_no_harder_than_its_sole_can_hold(pose):
    q, _, _ = pose
    q = np.array([0.0, 0.85, -0.1, 0.2, -0.3, 0.1, 0.2, -0.3, 0.1])
    poses = poses_along(q[None], np.zeros((1, 9)), PERSON)[0]
    wanted = q.copy()
    wanted[0] += 0.2
    position, slope, share = np.tile(wanted, (5, 1)), np.zeros((5, 9)), np.tile([0.5, 0.5], (5, 1))
    given = []
    for room in (None, np.tile([20.0, 6.0, 20.0, 9.0], (4, 1))):
        it = wearer_torques.mover(PERSON, torque=np.zeros((4, 8)), dofs=DOFS, room=room)
        it.placement[:] = 0.0
        wearer_torques.ask(0.3, 1.0, 0.0, 0.0, position, slope, share, q, np.zeros(9), poses, PERSON.lengths(), it)
        given.append(it.applied.copy())
    assert given[0][5] > 50.0 and given[0][8] > 50.0  # dorsiflexion, which would lift the toes
    assert given[1][5] == pytest.approx(6.0) and given[1][8] == pytest.approx(9.0)
    assert np.abs(given[1][3:5]).max() < np.abs(given[0][3:5]).max()


def _foot_in_the_air(it, off, fast):
    """Return the poses that are wanted, left foot in the air, of a pelvis on its path and of one off it [m], faster [m/s]: (7, 6) each."""
    wanted = np.array([0.0, 0.85, -0.1, 0.5, -0.6, 0.1, 0.2, -0.4, 0.2])
    position, slope, share = np.tile(wanted, (5, 1)), np.zeros((5, 9)), np.tile([0.0, 1.0], (5, 1))
    q, v = wanted.copy(), np.zeros(9)
    q[0], v[0] = off, fast
    poses = poses_along(q[None], v[None], PERSON)[0]
    wearer_torques.ask(0.3, 1.0, 0.0, 0.0, position, slope, share, q, v, poses, PERSON.lengths(), it)
    before, after = (poses_along(one[None], np.zeros((1, 9)), PERSON)[0] for one in (wanted, it.wanted))
    return before, after


def test_the_swinging_foot_is_put_farther_ahead_of_a_pelvis_that_is_faster():
    """As high and as level as it was; a little of the way back to where the reference has it on the ground."""
    it = wearer_torques.mover(PERSON, torque=np.zeros((4, 8)), dofs=DOFS)
    before, after = _foot_in_the_air(it, 0.03, 0.2)
    way = wearer_torques.FASTER * (0.2 - wearer_torques.ALLOWED) - wearer_torques.BACK * 0.03
    assert way > 0.04
    np.testing.assert_allclose(after[3, :3] - before[3, :3], [way, 0.0, 0.0], atol=0.2 * way)
    np.testing.assert_allclose(after[4:7], before[4:7], atol=1e-12)  # the leg that stands has the reference's angles
    slower = _foot_in_the_air(it, 0.0, -0.2)
    assert slower[1][3, 0] < slower[0][3, 0] - 0.04


def test_a_step_changes_no_farther_than_it_can_and_not_for_little():
    it = wearer_torques.mover(PERSON, torque=np.zeros((4, 8)), dofs=DOFS)
    before, after = _foot_in_the_air(it, 2.0, 0.0)
    far = before[3, 0] - after[3, 0]
    assert 0.5 * wearer_torques.MOST_MOVED < far < 1.5 * wearer_torques.MOST_MOVED
    before, after = _foot_in_the_air(it, 0.0, 0.9 * wearer_torques.ALLOWED)
    np.testing.assert_allclose(after, before, atol=1e-12)


def _with_foot_fixed(q, move):
    """Return the rates of the left leg's joints that keep its foot still while the pelvis moves."""

    def foot(v):
        return poses_along(q[None], v[None], PERSON)[0, 3, 3:]

    base = foot(np.concatenate([move, np.zeros(6)]))
    legs = np.stack([foot(np.eye(9)[j]) for j in (3, 4, 5)], axis=1)
    return np.linalg.solve(legs, -base)


def test_a_heavier_wearer_is_stiffer_in_proportion():
    usual, heavy = wearer_torques.mover(Person(1.7, 75.0)), wearer_torques.mover(Person(1.7, 75.0), carried=37.5)
    np.testing.assert_allclose(heavy.stiffness, 1.5 * usual.stiffness)
    np.testing.assert_allclose(heavy.pelvis_stiffness, 1.5 * usual.pelvis_stiffness)
