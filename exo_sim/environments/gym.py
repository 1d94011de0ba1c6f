"""The same environment in Gymnasium (the extra `gymnasium`)."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from exo_sim.environments.episode import Episode


class WalkEnv(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """A worn machine moved by actions from -1 to 1; observations are the groups of `Episode.observation` in one vector.

    Args:
        scenario: Name of a scenario or path of a scenario file.
        settings: As `environments.episode.Episode` takes them; `seed` is given to `reset` here.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - an attribute of the class, as Gymnasium declares it

    def __init__(self, scenario: str = "level_walk", render_mode: str | None = None, **settings: Any) -> None:
        self.episode = Episode(scenario, **settings)
        self.render_mode = render_mode
        size = len(self.episode.flat(self.episode.observation()))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(self.episode.action_names),), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode; chance is that of Gymnasium's generator, so that the same seed gives the same episode."""
        super().reset(seed=seed)
        self.episode.random = self.np_random
        return self._vector(self.episode.reset()), {}

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Act for one control step; terminated is a fall, truncated the end of the time."""
        reward = self.episode.step(action)
        it = self.episode
        over = it.steps >= it.steps_limit and not it.fallen
        return self._vector(it.observation()), reward, it.fallen, over, {"time": it.steps * it.control_timestep}

    def _vector(self, observation: Any) -> NDArray[np.float32]:
        return np.nan_to_num(self.episode.flat(observation)).astype(np.float32)
