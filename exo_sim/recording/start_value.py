"""The pressure with which a prediction begins, from the samples that follow.

A local parabola through noisy samples is less noisy at their start than the first of them only where there are many (of n its variance is
3 (3 n^2 - 3 n + 2) / (n (n + 1) (n + 2)) of one sample's, 0.46 for fifteen), and it is off where they span longer than the gas takes to
bend.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording import local_polynomial

Array = NDArray[np.float64]

#: The parabola goes through so many samples at most, and spans no more than this [s]; of fewer the first one counts. Whole machines X2,
#: X10, X11 and X12, logged at 200 and 400 samples a second, with 250 Pa of noise added: over 30 ms it is off by 1.4, 0.46, 2.1 and 3.4 kPa
#: (rms of 40 windows and both chambers), over 15 ms by 0.26, 0.38, 0.57 and 0.25, the first sample by 0.24 to 0.27.
MOST, SPAN, FEWEST = 15, 0.015, 11


def start_points(time: Array) -> int:
    """Return how many samples of a clock [s] estimate the value at the start of a window."""
    if len(time) < 2:
        return 1
    points = min(MOST, int(SPAN / max(float(np.median(np.diff(time))), 1e-9) * (1.0 + 1e-6)) + 1)
    return points if points >= FEWEST else 1


def start_value(values: Array, points: int) -> float:
    """Return the value at the start of a window from its samples, by so many of them; NaN where none is finite.

    Where one of them is missing it is the first that is not.
    """
    good = np.isfinite(values)
    if not good.any():
        return math.nan
    points = min(points, len(values))
    if points < FEWEST or not good[:points].all():
        return float(values[int(np.argmax(good))])
    return float(_weights(points) @ values[:points])


@lru_cache(maxsize=64)  # asked for every window
def _weights(points: int) -> Array:
    """Return the weights of the samples in the value at their start."""
    return local_polynomial.weights(points, 2, at=0)
