"""The dm_env environment, built on `dm_control.rl.control`."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import numpy as np
from dm_control.rl import control
from dm_env import specs

from exo_sim.environments.episode import Episode


class WalkPhysics(control.Physics):  # type: ignore[misc]
    """The coupled simulation as dm_control's `Physics`: a step is MuJoCo, gas, straps and valve controllers together."""

    def __init__(self, episode: Episode) -> None:
        self.episode = episode
        self.action = np.zeros(len(episode.action_names))
        self.reward = 0.0

    def step(self, n_sub_steps: int = 1) -> None:
        """Take one control step."""
        self.reward = self.episode.step(self.action)

    def time(self) -> float:
        """Return the time since the episode began [s]."""
        return self.episode.steps * self.episode.control_timestep

    def timestep(self) -> float:
        """Return the step of the simulation [s]."""
        return self.episode.timestep

    def set_control(self, control: Any) -> None:
        """Let an action count from now on."""
        self.action = np.asarray(control, dtype=np.float64)

    def reset(self) -> None:
        """Put the machine on the wearer."""
        self.episode.reset()

    def after_reset(self) -> None:
        """Nothing is left to do."""


class WalkTask(control.Task):  # type: ignore[misc]
    """What is acted, observed and rewarded; see `environments.episode`."""

    def initialize_episode(self, physics: WalkPhysics) -> None:
        """Nothing is left to do: the physics were reset."""

    def action_spec(self, physics: WalkPhysics) -> specs.BoundedArray:
        """Return -1 to 1 for each of `Episode.action_names`."""
        names = physics.episode.action_names
        return specs.BoundedArray((len(names),), np.float64, -1.0, 1.0, name="\t".join(names))

    def before_step(self, action: Any, physics: WalkPhysics) -> None:
        """Hand the action on."""
        physics.set_control(action)

    def after_step(self, physics: WalkPhysics) -> None:
        """Nothing is left to do."""

    def get_observation(self, physics: WalkPhysics) -> OrderedDict[str, Any]:
        """Return the observation by groups."""
        return physics.episode.observation()

    def observation_spec(self, physics: WalkPhysics) -> OrderedDict[str, specs.Array]:
        """Return shape and type of each group."""
        seen = physics.episode.observation()
        return OrderedDict((key, specs.Array(values.shape, np.float64, name=key)) for key, values in seen.items())

    def get_reward(self, physics: WalkPhysics) -> float:
        """Return the reward of the last step."""
        return physics.reward

    def get_termination(self, physics: WalkPhysics) -> float | None:
        """Return 0 after a fall, else None."""
        return 0.0 if physics.episode.fallen else None


def environment(scenario: str, **settings: Any) -> control.Environment:
    """Return the environment of a scenario; see `environments.load`."""
    episode = Episode(scenario, **settings)
    return control.Environment(WalkPhysics(episode), WalkTask(), time_limit=episode.time_limit, n_sub_steps=episode.substeps)
