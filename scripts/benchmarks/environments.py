"""Simulated seconds a second of processor time of the learning environments, one copy of each."""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np

from benchmarks.figure import Asked, Figure, Said
from exo_sim import environments

STEPS, TIMESTEP, ASKED = 100, 0.02, 20.0


def measure(asked: Asked) -> Said:
    """Measure walking with no torque, from the processor's clock: other work on the machine counts little."""
    said: list[Figure | str] = []
    if find_spec("dm_control") is None:
        said.append("environments: no dm_control, whose environment was not measured")
    else:
        task = environments.load("level_walk", payload="34 kg", control_timestep=TIMESTEP, seed=1)
        task.reset()
        still = np.zeros(task.action_spec().shape)
        said.append(_figure("dm_env", lambda: task.step(still)))
    if find_spec("gymnasium") is None:
        return [*said, "environments: no gymnasium, whose environment was not measured"]
    import gymnasium

    other = gymnasium.make("exo_sim/LevelWalk-v0", payload="34 kg", control_timestep=TIMESTEP)
    other.reset(seed=1)
    nothing = np.zeros(other.action_space.shape or (), dtype=np.float32)
    return [*said, _figure("gymnasium", lambda: other.step(nothing))]


def _figure(name: str, step: Callable[[], object]) -> Figure:
    """Return the best of three runs of `STEPS` steps, within one episode."""
    step()
    taken = []
    for _ in range(3):
        begun = time.process_time()
        for _ in range(STEPS // 2):
            step()
        taken.append(time.process_time() - begun)
    rate = STEPS // 2 * TIMESTEP / min(taken)
    return Figure(f"{name}_times_real_time", f"environment, {name}", rate, "{:.1f} times real time", above=ASKED)
