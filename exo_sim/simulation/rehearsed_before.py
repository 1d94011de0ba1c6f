"""All that rehearsed torques follow from, as bytes: a walk that was prepared before need not be rehearsed again."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from exo_sim.physics import external_effects

if TYPE_CHECKING:
    from exo_sim.simulation.worn import Simulation


def identity(it: Simulation, model: mujoco.MjModel, payload: float) -> bytes:
    """Return what rehearsed torques follow from, beside the program.

    Args:
        it: The walk.
        model: Of machine and payload.
        payload: On the back [kg].
    """
    asked = it.request
    compiled = np.empty(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, compiled)
    how = (
        payload, asked.payload, asked.assist, asked.controller, asked.law, asked.rehearsals, asked.weights, asked.gains, dict(asked.tuned),
        asked.signals, asked.ideal, asked.moved_by, it.seed if asked.signals != "exact" else 0,
    )  # fmt: skip
    effects = [source.path.read_bytes() for source in external_effects.sources()]
    return compiled.tobytes() + pickle.dumps((how, it.rig, it.person, it.motion, it.straps, effects), protocol=5)
