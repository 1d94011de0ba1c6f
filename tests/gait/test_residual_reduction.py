"""Motions that a body with mass can do, held against recorded ground forces and moments."""

import numpy as np
import pytest

from exo_sim.gait import recorded_gait, scenario
from exo_sim.gait.motion import SAMPLES, phases
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.gait.residual_reduction import reduced, with_backpack
from exo_sim.machine import ground_reaction
from exo_sim.machine.person import Person, poses_along


def held(motion, person):
    poses, wrench = body_loads(Moving.of(motion), person)
    ground = ground_reaction.hold(poses, wrench, motion.share, motion.pressure_centre, motion.support, person)
    return ground, ground_reaction.joint_moments(poses, wrench, ground.force, ground.place)


@pytest.fixture(scope="module")
def walker():
    person = Person(1.70, recorded_gait.load("falisse").mass)
    plain = scenario.motion("level_walk", person, 1.0)
    return person, plain, reduced(plain, person)


def test_level_walking_needs_no_hand_at_the_pelvis(walker):
    person, plain, motion = walker
    assert np.abs(held(plain, person)[0].residual[:, 2]).max() > 30.0
    assert np.abs(held(motion, person)[0].residual).max() < 1.0


def test_feet_stay_where_they_are_and_legs_move_little(walker):
    person, plain, motion = walker
    before, after = (poses_along(it.position, np.zeros_like(it.position), person)[:, ground_reaction.FEET] for it in (plain, motion))
    np.testing.assert_allclose(after[:, :, 2], before[:, :, 2], atol=1e-12)  # a foot is as flat as it was
    assert np.abs(after - before)[:, :, 0].max() < 2e-3 and np.abs(after - before)[:, :, 1].max() < 3e-3
    moved = np.abs(motion.position - plain.position)
    assert moved[:, 0].max() < 10e-3 and moved[:, 1].max() < 1e-3
    assert np.degrees(moved[:, [4, 5, 7, 8]]).max() < 1.5


@pytest.mark.parametrize("scene", ["level_walk", "level_walk_opensim", "slow_walk", "fast_walk"])
def test_a_foot_on_the_ground_slides_less_than_a_thumb_is_thick(scene):
    """With the pelvis alone moved, feet slid with it: 5 mm and 8 mm in level walking."""
    person = Person()
    plain = scenario.motion(scene, person, 1.0)
    for motion in (reduced(plain, person), with_backpack(plain, person, (-0.18, 0.33), 34.0, 0.02)):
        way = motion.position[:, 0] + motion.advance * motion.phase
        for foot, row in enumerate(ground_reaction.FEET):
            pose = poses_along(np.column_stack([way, motion.position[:, 1:]]), np.zeros_like(motion.position), person)[:, row]
            for k, ahead in enumerate((person.heel, person.toe)):
                at = pose[:, 0] + ahead * np.cos(pose[:, 2]) + person.ankle_height * np.sin(pose[:, 2])
                down = motion.contact[:, 2 * foot + k]
                lands = int(np.argmax(down & ~np.roll(down, 1)))
                at, down = np.roll(at, -lands), np.roll(down, -lands)
                at[len(at) - lands :] += motion.advance
                stands = at[15 : int(np.argmin(down)) - 15]
                assert len(stands) > 80
                assert np.ptp(stands) < 8e-3, (scene, foot, ahead)


def test_a_backpack_makes_the_trunk_lean(walker):
    person, plain, motion = walker
    carrying = with_backpack(plain, person, (-0.18, 0.33), 34.0, 0.02)
    assert np.degrees(np.mean(motion.position[:, 2] - carrying.position[:, 2])) > 5.0


@pytest.mark.parametrize("name, scene, reached", [
    ("falisse", "level_walk", (0.19, 0.09, 0.105)),
    ("opensim", "level_walk_opensim", (0.165, 0.12, 0.12)),
])  # fmt: skip
def test_moments_are_near_the_recorded_ones(name, scene, reached):
    """Issue 18 asks for 0.2 N m/kg."""
    gait = recorded_gait.load(name)
    person = Person(1.70, gait.mass)
    ground, moments = held(reduced(scenario.motion(scene, person, 1.0), person), person)
    assert np.abs(ground.residual).max() < 1.0
    for k, (joint, bound) in enumerate(zip(("hip", "knee", "ankle"), reached)):
        wanted = gait.moment[joint](phases())
        assert np.sqrt(np.mean((moments[:, 3 + k] - wanted) ** 2)) / person.mass < bound, joint
        assert np.corrcoef(moments[:, 3 + k], wanted)[0, 1] > 0.8, joint


@pytest.mark.real_data
def test_ground_forces_are_near_the_recorded_ones(walker, shared_data):
    """The recorded vertical force, which does not sum to the weight, is scaled so that it does."""
    from scipy.io import loadmat

    person, _, motion = walker
    data = loadmat(shared_data / "walking_falisse" / "ExperimentalData.mat", squeeze_me=True, struct_as_record=False)
    measured = data["ExperimentalData"].GRFs.subject1.mean[:, :2]
    measured = measured / measured[:, 1].mean() * 0.5
    phase = np.arange(SAMPLES) / SAMPLES
    wanted = np.stack([np.interp(phase, np.arange(100) / 100, one, period=1.0) for one in measured.T], axis=1)
    force = held(motion, person)[0].force[:, 1] / (person.mass * 9.81)
    assert np.sqrt(np.mean((force[:, 1] - wanted[:, 1]) ** 2)) < 0.035
    assert np.corrcoef(force[:, 1], wanted[:, 1])[0, 1] > 0.98
    assert np.corrcoef(force[:, 0], wanted[:, 0])[0, 1] > 0.96
    assert force[:, 1].max() < wanted[:, 1].max() + 0.08


@pytest.mark.real_data
def test_the_load_passes_from_foot_to_foot_as_recorded(walker, shared_data):
    from scipy.io import loadmat

    data = loadmat(shared_data / "walking_falisse" / "ExperimentalData.mat", squeeze_me=True, struct_as_record=False)
    up = data["ExperimentalData"].GRFs.subject1.mean[:, 1]
    share = np.interp(phases(), np.arange(100) / 100, up / (up + np.roll(up, 50)), period=1.0)
    assert np.sqrt(np.mean((walker[2].share[:, 1] - share) ** 2)) < 0.035
