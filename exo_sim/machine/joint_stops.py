"""Where a joint lies against a stop of its MJCF."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray


def touches_stop(model: mujoco.MjModel, joint: int, position: NDArray[np.float64], slack: float) -> NDArray[np.bool_]:
    """Return where a joint is so near to an end of its range that the stop may push it, shape (n,).

    Args:
        model: With the stops.
        joint: Its index.
        position: Of the joint, shape (n,) [m or rad].
        slack: How near, beyond the margin at which MuJoCo's stop begins [m or rad].
    """
    if not model.jnt_limited[joint]:
        return np.zeros(len(position), dtype=bool)
    low, high = model.jnt_range[joint]
    near = float(model.jnt_margin[joint]) + slack
    return np.asarray((position < low + near) | (position > high - near))
