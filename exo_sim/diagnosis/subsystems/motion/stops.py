"""Where a joint lies against a stop of its MJCF, or a piston against an end of its cylinder: what pushes it there, nobody recorded."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from exo_sim.diagnosis.policy.recordings import AT_STOP_NOISE, END_OF_STROKE
from exo_sim.diagnosis.subsystems.motion.smoothing import reach
from exo_sim.machine.joint_stops import touches_stop
from exo_sim.recording.filters import SmoothedMotion
from exo_sim.rig import Cylinder

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
    touching = touches_stop(model, joint, move.position, AT_STOP_NOISE * move.position_noise)
    return np.asarray(binary_dilation(touching, iterations=reach(time, smoothing)))


def at_end(cylinder: Cylinder, time: Array, rod: SmoothedMotion) -> NDArray[np.bool_]:
    """Return where the balance along a rod holds the push of an end of its cylinder, shape (n,).

    Nowhere where that would be most of the time: such a rig has its lengths wrong, and its piston works.

    Args:
        cylinder: With its stroke.
        time: Of the samples, shape (n,) [s].
        rod: How the rod moved; its position is the actuator's length.
    """
    near = END_OF_STROKE * cylinder.stroke + AT_STOP_NOISE * rod.position_noise
    out = rod.position - cylinder.retracted_length
    touching = binary_dilation((out < near) | (out > cylinder.stroke - near), iterations=reach(time))
    return np.asarray(touching if touching.mean() < 0.5 else np.zeros(len(time), dtype=bool))
