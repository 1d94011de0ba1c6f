"""The error process of a fitted subsystem: white noise and a discrepancy that is correlated in time, as one ARMA(1,1) process.

Sensors leave white noise; what every model gets wrong comes and goes with the machine's motion. Their sum, noise plus a first-order
Markov process, is an ARMA(1,1) process (Granger and Morris 1976): r_t = phi r_(t-1) + e_t - theta e_(t-1). Its inverse filter turns
residuals and signatures into independent rows of variance 1, so that slow effects are not counted as often as there are samples.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy import priors
from exo_sim.physics.compiled import kernel

Array = NDArray[np.float64]

#: Autoregressive and moving-average coefficients that are tried.
_PHI = (0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.975, 0.99)
_THETA = (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95)


@dataclass(frozen=True)
class NoiseModel:
    """An ARMA(1,1) process for the rows of a residual.

    Attributes:
        phi, theta: Its coefficients.
        innovation: Standard deviation of e.
        blocks: Block of time of each row, shape (n,); the process begins anew with each.
    """

    phi: float
    theta: float
    innovation: float
    blocks: NDArray[np.int64]

    def whitened(self, rows: Array) -> Array:
        """Return rows as independent rows of variance 1; shape (n,) or (n, p), filtered along the first axis."""
        return _innovations(rows, self.blocks, self.phi, self.theta) / self.innovation


def noise_model(residual: Array, blocks: NDArray[np.int64]) -> NoiseModel:
    """Return the process of greatest conditional likelihood for a residual.

    Args:
        residual: Whitened by the sensors' noise, shape (n,).
        blocks: Block of time of each row, shape (n,).
    """
    best: tuple[float, float, float] | None = None
    for phi in _PHI:
        for theta in _THETA:
            if theta > phi or (phi == 0.0 and theta > 0.0):
                continue
            errors = _innovations(residual, blocks, phi, theta)
            variance = float(errors @ errors) / max(residual.size, 1)
            if best is None or variance < best[0] * (1.0 - 1e-9):
                best = variance, phi, theta
    assert best is not None
    variance, phi, theta = best
    return NoiseModel(phi, theta, max(math.sqrt(variance), priors.LEAST_INNOVATION), blocks)


def _innovations(rows: Array, blocks: NDArray[np.int64], phi: float, theta: float) -> Array:
    """Return the innovations of an ARMA(1,1) process, each block begun with its stationary spread; shape as `rows`."""
    if phi == 0.0:
        return rows
    found = np.empty(rows.shape)
    first = math.sqrt((1.0 - phi * phi) / (1.0 + theta * theta - 2.0 * phi * theta))
    columns = np.ascontiguousarray(rows).reshape(len(rows), -1)
    _filter(columns, np.ascontiguousarray(blocks), phi, theta, first, found.reshape(columns.shape))
    return found


@kernel
def _filter(rows, blocks, phi, theta, first, out):
    """Write the innovations of columns (n, p) into `out`, the first of each block `first` times its row: blocks are too many for SciPy."""
    n, p = rows.shape
    for j in range(p):
        state = 0.0
        for i in range(n):
            begins = i == 0 or blocks[i] != blocks[i - 1]
            if begins:
                state = 0.0
            e = state + rows[i, j]
            state = theta * e - phi * rows[i, j]
            out[i, j] = first * rows[i, j] if begins else e
