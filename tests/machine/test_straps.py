"""Straps: slack upright, equal and opposite, real velocities; and what they ask of the wearer."""

import mujoco
import numpy as np
import pytest

from exo_sim.errors import ModelError
from exo_sim.machine.person import SEGMENTS, Person, segment_poses
from exo_sim.machine.straps import Strap, fasten, pull
from exo_sim.machine.wearer_moments import GRAVITY, backpack_wrench, extra_moments
from exo_sim.machine.worn_model import build
from exo_sim.rig import Ankle


@pytest.fixture(scope="module")
def worn(repository):
    person = Person()
    model = build(repository / "assets" / "exo.xml", person, 34.0, Ankle())
    return person, model, fasten(model, person)


def pulled(worn, q, v, qpos, qvel):
    person, model, straps = worn
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = qpos, qvel
    mujoco.mj_forward(model, data)
    poses, force, wrench = np.zeros((7, 6)), np.zeros((len(straps.names), 2)), np.zeros((7, 3))
    segment_poses(q, v, person.lengths(), poses)
    root = model.body("torso").id
    pull(poses, data.xpos, data.xmat, data.xipos, data.cvel, data.subtree_com[root], straps.body, straps.local,
         straps.segment, straps.anchor, straps.stiffness, straps.damping, straps.least, data.xfrc_applied, force,
         np.zeros((len(straps.names), 2)), np.zeros(len(straps.names)), wrench)  # fmt: skip
    return data, poses, force, wrench


def test_straps_are_slack_where_machine_and_person_move_as_one(worn):
    rng = np.random.default_rng(3)
    q = np.array([0.4, 0.86, -0.1, 0.5, -0.6, 0.2, -0.2, -0.1, 0.1])
    v = rng.normal(size=9)
    _, _, force, wrench = pulled(worn, q, v, q, v)
    assert np.abs(force).max() < 1e-6
    assert np.abs(wrench).max() < 1e-6


def test_what_the_machine_gains_the_person_loses(worn):
    rng = np.random.default_rng(4)
    q = np.array([0.0, 0.86, -0.1, 0.5, -0.6, 0.2, -0.2, -0.1, 0.1])
    qpos, v, qvel = q + 0.02 * rng.normal(size=9), rng.normal(size=9), rng.normal(size=9)
    data, poses, force, wrench = pulled(worn, q, v, qpos, qvel)
    assert np.abs(force).max() > 50.0
    on_machine = data.xfrc_applied[:, [0, 2]].sum(axis=0)
    np.testing.assert_allclose(on_machine, force.sum(axis=0), atol=1e-9)
    np.testing.assert_allclose(wrench[:, :2].sum(axis=0), -on_machine, atol=1e-9)
    # the straps' damping takes energy: with springs slack the power of both sides is negative
    data, poses, force, wrench = pulled(worn, q, v, q, qvel)
    power = float(data.qfrc_applied @ qvel)
    applied = np.zeros(9)
    for body in range(1, worn[1].nbody):
        mujoco.mj_applyFT(
            worn[1], data, data.xfrc_applied[body, :3], data.xfrc_applied[body, 3:], data.xipos[body], body, applied
        )
    power += float(applied @ qvel)
    power += float(np.sum(wrench[:, 0] * poses[:, 3] + wrench[:, 1] * poses[:, 4] + wrench[:, 2] * poses[:, 5]))
    assert power < -1.0


def test_a_spring_pulls_with_its_stiffness(worn):
    q = np.array([0.0, 0.879, 0, 0, 0, 0, 0, 0, 0], dtype=float)
    qpos = q.copy()
    qpos[1] += 0.01
    _, _, force, _ = pulled(worn, q, np.zeros(9), qpos, np.zeros(9))
    by_name = dict(zip(worn[2].names, force))
    assert by_name["torso_strap_low"] == pytest.approx([0.0, -80.0], abs=1e-9)
    assert by_name["thigh_l_strap"] == pytest.approx([0.0, -10.0], abs=1e-9)


def test_a_missing_site_is_named(worn):
    with pytest.raises(ModelError, match='"belt"'):
        fasten(worn[1], worn[0], (Strap("belt", "torso", (1.0, 1.0), (0.0, 0.0)),))


def standing_on_one_leg(share):
    person = Person()
    q = np.array([0.0, 0.879, 0, 0, 0, 0, 0, 0, 0], dtype=float)
    poses = np.zeros((7, 6))
    segment_poses(q, np.zeros(9), person.lengths(), poses)
    return person, poses[None], np.array([share]), np.array([[0.04, 0.04]])


def test_a_backpack_behind_a_standing_person_bends_every_joint_by_its_lever():
    person, poses, share, centre = standing_on_one_leg([1.0, 0.0])
    still = np.array([[0.0, 0.879, 0.0, 0.0, 0.0, 0.0]])
    wrench = backpack_wrench(still, np.zeros((1, 3)), (-0.18, 0.33), np.array([34.0]), 0.02)
    moment = 34.0 * GRAVITY * 0.18
    extra = extra_moments(poses, wrench, share, centre, person.ankle_height)[0]
    np.testing.assert_allclose(np.abs(extra[:3]), moment, rtol=5e-3)
    assert np.abs(extra[3:]).max() < 1.0


def test_a_force_along_the_leg_asks_nothing():
    person, poses, share, centre = standing_on_one_leg([0.5, 0.5])
    wrench = np.zeros((1, 7, 3))
    wrench[0, SEGMENTS.index("torso"), 1] = -400.0
    shifted = extra_moments(poses, wrench, share, np.zeros((1, 2)), person.ankle_height)[0]
    assert np.abs(shifted).max() < 1e-9
    assert np.abs(extra_moments(poses, wrench, share, centre, person.ankle_height)[0]).max() < 20.0


def test_a_force_on_a_foot_goes_into_the_ground_there():
    person, poses, share, centre = standing_on_one_leg([1.0, 0.0])
    wrench = np.zeros((1, 7, 3))
    wrench[0, SEGMENTS.index("foot_l")] = [30.0, -100.0, 4.0]
    extra = extra_moments(poses, wrench, share, centre, person.ankle_height)[0]
    assert np.abs(extra[:3]).max() < 0.2


def test_stiffened_straps_keep_their_damping_ratio(worn):
    _, _, straps = worn
    twice = straps.stiffened(2.0)
    np.testing.assert_allclose(twice.stiffness, 2.0 * straps.stiffness)
    np.testing.assert_allclose(twice.damping**2 / twice.stiffness, straps.damping**2 / straps.stiffness)
    assert twice.names == straps.names
