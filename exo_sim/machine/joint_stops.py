"""Where a joint lies against a stop of its MJCF."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.deciding_number import Number

AT_STOP_NOISE = Number(
    4.0, "standard deviations of the position's noise", "a joint that is closer to a stop of its MJCF may lie against it",
    "a suit with a heavier load on its back ran a knee 1 degree into its stop: 20 times the noise, and no name",
)  # fmt: skip


def touches_stop(model: mujoco.MjModel, joint: int, position: NDArray[np.float64], noise: float) -> NDArray[np.bool_]:
    """Return where a joint is so near to an end of its range that the stop may push it, shape (n,).

    Args:
        model: With the stops.
        joint: Its index.
        position: Of the joint, shape (n,) [m or rad].
        noise: Standard deviation of the position's noise [m or rad].
    """
    if not model.jnt_limited[joint]:
        return np.zeros(len(position), dtype=bool)
    low, high = model.jnt_range[joint]
    near = float(model.jnt_margin[joint]) + AT_STOP_NOISE * noise
    return np.asarray((position < low + near) | (position > high - near))
