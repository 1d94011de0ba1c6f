"""Bursts of a pressure error that are too fast for the rows of a fit: something rings, and no slow effect explains it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Stretches over which the level of the fast error is taken, in samples.
STRETCH = 50
#: The lively stretches are those above this percentile of the levels; a sensor's own noise is as loud in every stretch.
LIVELY = 95.0


def burst_ratio(fast: Array, noise: float) -> float:
    """Return the level of the lively stretches over the median level, or over the sensor's noise where that is larger.

    Args:
        fast: Errors less the mean of their row, shape (n,).
        noise: Standard deviation of the sensor's white noise.
    """
    count = len(fast) // STRETCH
    if count < 2:
        return 0.0
    level = np.sqrt(np.mean(fast[: count * STRETCH].reshape(count, STRETCH) ** 2, axis=1))
    return float(np.percentile(level, LIVELY) / max(noise, float(np.median(level)), 1e-12))
