"""What an effect gains on held-out time, block by block."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.correlation import Blocked
from exo_sim.diagnosis.selection.evidence import misfit

Array = NDArray[np.float64]


def gain_in_errors(rows: Blocked, without: Array, with_it: Array) -> float:
    """Return by how many standard errors the mean gain of a block of time exceeds nil; minus infinity for fewer than two blocks.

    The gain of a block is that in the log-likelihood of a row whose level of error is unknown: beside something that has no name the
    errors of one block may be many times those of another, and the loudest must not decide alone, neither for an effect nor against it.

    Args:
        rows: Whose rows they are.
        without, with_it: Whitened residuals of two models, shape (n,).
    """
    count = np.bincount(rows.blocks)
    there = count > 0
    levels = [np.bincount(rows.blocks, weights=one**2)[there] / count[there] for one in (without, with_it)]
    gains = np.array([0.5 * (misfit(a) - misfit(b)) for a, b in zip(*levels, strict=True)])
    if gains.size < 2 or not np.isfinite(gains).all():
        return -math.inf
    error = float(gains.std(ddof=1)) / math.sqrt(gains.size)
    mean = float(gains.mean())
    return mean / error if error > 0.0 else math.copysign(math.inf, mean) if mean else 0.0
