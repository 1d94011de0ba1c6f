"""Regimes of a balance of forces: direction, slow, fast, near a reversal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.trace import near_reversal
from exo_sim.diagnosis.policy.regimes import FAST, SLOW

Array = NDArray[np.float64]


def regimes(velocity: Array, time: Array) -> dict[str, NDArray[np.bool_]]:
    """Return the regimes by name, shape (n,) each."""
    fast = np.abs(velocity) > np.percentile(np.abs(velocity), FAST)
    slow = np.abs(velocity) < np.percentile(np.abs(velocity), SLOW)
    return {
        "moving out": velocity > 0.0,
        "moving in": velocity < 0.0,
        "moving fast": fast,
        "moving slowly": slow,
        "near a reversal": near_reversal(time, velocity),
    }
