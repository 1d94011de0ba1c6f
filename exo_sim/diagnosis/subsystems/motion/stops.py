"""Where a joint lies against a stop of its MJCF: what pushes it there, nobody recorded."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from exo_sim.diagnosis.subsystems.motion.smoothing import reach
from exo_sim.machine.joint_stops import touches_stop
from exo_sim.recording.filters import SmoothedMotion

Array = NDArray[np.float64]


def at_stop(model: mujoco.MjModel, joint: int, time: Array, move: SmoothedMotion, smoothing: float = 0.0) -> NDArray[np.bool_]:
    """Return where the balance of a joint holds the push of a stop, shape (n,).

    Args:
        model: With the stops.
        joint: Its index.
        time: Of the samples, shape (n,) [s].
        move: How it moved.
        smoothing: Width of the filter that noise asks for [s].
    """
    touching = touches_stop(model, joint, move.position, move.position_noise)
    return np.asarray(binary_dilation(touching, iterations=reach(time, smoothing)))
