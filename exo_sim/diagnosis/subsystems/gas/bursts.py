"""Bursts of a pressure error that are too fast for the rows of a fit: something rings, and no slow effect explains it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.healthy import BURST_LENGTH, LIVELY

Array = NDArray[np.float64]


def burst_ratio(fast: Array, noise: float) -> float:
    """Return the level of the lively stretches over the median level, or over the sensor's noise where that is larger.

    Args:
        fast: Errors less the mean of their row, shape (n,).
        noise: Standard deviation of the sensor's white noise.
    """
    count = len(fast) // BURST_LENGTH
    if count < 2:
        return 0.0
    level = np.sqrt(np.mean(fast[: count * BURST_LENGTH].reshape(count, BURST_LENGTH) ** 2, axis=1))
    return float(np.percentile(level, LIVELY) / max(noise, float(np.median(level)), 1e-12))
