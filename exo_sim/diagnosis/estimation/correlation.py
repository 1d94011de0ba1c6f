"""Correlation of residuals: their integrated autocorrelation time, which divides the number of rows into an effective sample size."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.acceptance import FEWEST_PAIRS, UNCORRELATED

Array = NDArray[np.float64]

#: Lags, in rows, at which the autocorrelation is estimated.
_LAGS = (1, 2, 3, 4, 5, 6, 8, 10, 13, 16, 20, 26, 32, 40, 52, 64, 80, 100, 128, 160, 200)


class Blocked(Protocol):
    """Rows in blocks of time; those of one block that stand side by side are neighbours in time.

    A block may go on further behind, with onsets of motion.
    """

    @property
    def blocks(self) -> NDArray[np.int64]: ...

    @property
    def size(self) -> int: ...


def correlation_time(residual: Array, blocks: NDArray[np.int64]) -> float:
    """Return the integrated autocorrelation time of a residual inside blocks, in rows, at least 1 (Geyer 1992: cut off where it decays).

    Args:
        residual: Shape (n,).
        blocks: Block of each row, shape (n,).
    """
    variance = float(residual @ residual) / max(residual.size, 1)
    if variance <= 0.0 or not math.isfinite(variance):
        return 1.0
    total, last, height = 1.0, 0, 1.0
    for lag in _LAGS:
        same = blocks[lag:] == blocks[:-lag]
        count = int(np.count_nonzero(same))
        if count < FEWEST_PAIRS:
            break
        rho = float(np.sum(residual[lag:] * residual[:-lag] * same)) / count / variance
        # the trapezoid over the lags between, ends counted once
        total += (rho + height) * (lag - last) - (height - rho) if rho >= UNCORRELATED else 0.0
        if rho < UNCORRELATED:
            break
        last, height = lag, rho
    return max(total, 1.0)


def rms(errors: Array) -> float:
    """Return the root mean square of the finite errors; NaN where there are none."""
    good = errors[np.isfinite(errors)]
    return math.sqrt(float(good @ good) / good.size) if good.size else math.nan
