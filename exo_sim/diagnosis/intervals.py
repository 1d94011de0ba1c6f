"""How well a fit knows its numbers: 95 % intervals that bear correlated errors."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitting import Fit
from exo_sim.diagnosis.quantity import Quantity
from exo_sim.diagnosis.weighing import Blocked

#: 97.5 % quantile of the normal distribution.
_Z = 1.959963984540054


def spreads(problem: Blocked, fit: Fit, correlation: float) -> dict[Quantity, float]:
    """Return the standard deviation of every fitted number, in its unit.

    The larger of two: least squares with the residual's own variance and correlation time, and the sandwich over blocks of time,
    which also bears a model whose errors come in spells.

    Args:
        problem: The cut.
        fit: The fit.
        correlation: How many neighbouring rows say the same.
    """
    if not fit.quantities or not fit.residual.size:
        return {}
    jac, prior = fit.jacobian, fit.prior_rows.reshape(-1, len(fit.quantities))
    information = jac.T @ jac
    variance = max(fit.sse / max(fit.residual.size - len(fit.quantities), 1), 1.0) * correlation
    bread = np.linalg.pinv(information / variance + prior.T @ prior)
    blocks = problem.blocks
    count = int(blocks.max()) + 1
    scores = np.column_stack([np.bincount(blocks, weights=jac[:, j] * fit.residual, minlength=count) for j in range(jac.shape[1])])
    loose = np.linalg.pinv(information + prior.T @ prior)
    used = max(int(np.count_nonzero(np.bincount(blocks))), 2)
    sandwich = loose @ (scores.T @ scores) @ loose * used / max(used - len(fit.quantities), 1)
    found = {}
    for j, quantity in enumerate(fit.quantities):
        both = max(float(bread[j, j]), float(sandwich[j, j]), 0.0)
        found[quantity] = math.sqrt(both) * abs(quantity.slope(fit.values[quantity]))
    return found


def ends(value: float, spread: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a number that has no bounds."""
    return value - _Z * spread, value + _Z * spread


def bounds(quantity: Quantity, value: float, spread: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval, inside the quantity's own bounds."""
    low, high = ends(value, spread)
    return max(low, quantity.low), min(high, quantity.high)


def normalised(errors: NDArray[np.float64]) -> float:
    """Return the root mean square of what is finite."""
    good = errors[np.isfinite(errors)]
    return math.sqrt(float(good @ good) / good.size) if good.size else math.nan
