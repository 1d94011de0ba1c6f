"""The worn machine as a task for learning: the checkers of dm_env and Gymnasium, seeds, and what is rewarded."""

import unittest

import numpy as np
import pytest
from absl.testing import absltest
from dm_env import test_utils

from exo_sim import environments
from exo_sim.environments.episode import FALL, Episode
from exo_sim.errors import ExoSimError


@pytest.fixture(scope="module")
def episode():
    return Episode("level_walk", payload="34 kg", time_limit=1.0, seed=3)


class _Conforms(test_utils.EnvironmentTestMixin, absltest.TestCase):
    """The tests that dm_env has for environments."""

    def make_object_under_test(self):
        return environments.load("level_walk", payload="34 kg", time_limit=0.2, seed=1)

    def make_action_sequence(self):
        for value in (0.0, 1.0, -1.0):
            for _ in range(4):
                yield np.full(4, value)


def test_dm_env_finds_nothing_wrong():
    names = [name for name in dir(_Conforms) if name.startswith("test_")]
    result = unittest.TestResult()
    for name in names:
        _Conforms(name).run(result)
    assert result.testsRun == len(names) > 3
    assert not result.errors and not result.failures, [*result.errors, *result.failures]


def test_gymnasium_finds_nothing_wrong():
    gymnasium = pytest.importorskip("gymnasium")
    from gymnasium.utils.env_checker import check_env

    environment = gymnasium.make("exo_sim/LevelWalk-v0", payload="34 kg", time_limit=0.2)
    check_env(environment.unwrapped, skip_render_check=True)
    assert environments.gymnasium_id("sit_to_stand") in gymnasium.registry


def test_gymnasium_copies_side_by_side_and_its_two_ends():
    gymnasium = pytest.importorskip("gymnasium")
    copies = gymnasium.make_vec("exo_sim/LevelWalk-v0", num_envs=2, vectorization_mode="sync", payload="20 kg", time_limit=0.06)
    seen, _ = copies.reset(seed=5)
    assert seen.shape[0] == 2 and not np.array_equal(seen[0], seen[1])
    for _ in range(3):
        _, _, terminated, truncated, _ = copies.step(np.zeros((2, 4), dtype=np.float32))
    assert truncated.all() and not terminated.any()


def test_the_same_seed_is_the_same_episode(episode):
    actions = np.random.default_rng(0).uniform(-0.2, 0.2, (10, 4))
    runs = []
    for _ in range(2):
        episode.random = np.random.default_rng(7)
        first = episode.flat(episode.reset())
        rewards = [episode.step(action) for action in actions]
        runs.append((first, rewards, episode.flat(episode.observation())))
    for one, other in zip(*runs):
        np.testing.assert_array_equal(one, other)
    assert not np.array_equal(episode.flat(episode.reset()), runs[0][0])


def test_torques_that_carry_the_payload_are_rewarded():
    """Standing still: torques at hip and knee that hold frame and payload leave the wearer far less than none do."""
    stand = Episode("stand", payload=34.0, time_limit=2.0, random_start=False)

    def earned(torque):
        stand.reset()
        return np.mean([stand.step(torque) for _ in range(60)][30:])

    hold = np.full(4, 0.2)
    assert stand.action_names == ("hip_l.torque", "knee_l.torque", "hip_r.torque", "knee_r.torque")
    assert earned(hold) > 0.3 > 0.0 > earned(np.zeros(4)) > -1.0


def test_a_fall_ends_the_episode(episode):
    episode.reset()
    episode._stepper.simulation.data.qpos[2] = 2.0
    assert episode.step(np.zeros(4)) == FALL and episode.fallen


@pytest.mark.parametrize(
    ("settings", "hint"),
    [
        ({"scenario": "levelwalk"}, "level_walk"), ({"payload": "34"}, "unit"), ({"actions": "torque"}, 'did you mean "torques"'),
        ({"control_timestep": 0.0015}, "multiple"), ({"time_limit": 0.0}, "time_limit"), ({"rig": "none.toml"}, "no such rig"),
    ],
)  # fmt: skip
def test_wrong_settings_are_one_line(settings, hint):
    with pytest.raises(ExoSimError, match=hint) as error:
        environments.load(**settings)
    assert "\n" not in str(error.value)
