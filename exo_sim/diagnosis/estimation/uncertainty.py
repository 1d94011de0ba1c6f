"""How well a fit knows its parameters: standard errors and 95 % intervals that are robust to correlated residuals."""

from __future__ import annotations

import math

import numpy as np

from exo_sim.diagnosis.estimation.correlation import Blocked
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter

#: Standard errors from the middle of a 95 % interval to its ends: the 97.5 % quantile of the normal distribution.
HALF_WIDTH = 1.959963984540054


def standard_errors(rows: Blocked, fit: Fit, correlation_time: float) -> dict[FreeParameter, float]:
    """Return the standard error of every fitted parameter, in its unit.

    The larger of two: least squares with the residual's own variance and correlation time, and the sandwich estimator clustered by
    blocks of time, which also holds for a misspecified model with correlated residuals.

    Args:
        rows: Whose rows they are.
        fit: The fit.
        correlation_time: Of its residual, in rows.
    """
    if not fit.parameters or not fit.residual.size:
        return {}
    jac, prior = fit.jacobian, fit.prior_jacobian.reshape(-1, len(fit.parameters))
    information = jac.T @ jac
    variance = max(fit.sse / max(fit.residual.size - len(fit.parameters), 1), 1.0) * correlation_time
    bread = np.linalg.pinv(information / variance + prior.T @ prior)
    blocks = rows.blocks
    count = int(blocks.max()) + 1
    scores = np.column_stack([np.bincount(blocks, weights=jac[:, j] * fit.residual, minlength=count) for j in range(jac.shape[1])])
    loose = np.linalg.pinv(information + prior.T @ prior)
    used = max(int(np.count_nonzero(np.bincount(blocks))), 2)
    sandwich = loose @ (scores.T @ scores) @ loose * used / max(used - len(fit.parameters), 1)
    found = {}
    for j, parameter in enumerate(fit.parameters):
        both = max(float(bread[j, j]), float(sandwich[j, j]), 0.0)
        found[parameter] = math.sqrt(both) * abs(parameter.slope(fit.values[parameter]))
    return found


def interval(value: float, error: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a number without bounds, given its standard error."""
    return value - HALF_WIDTH * error, value + HALF_WIDTH * error


def bounded_interval(parameter: FreeParameter, value: float, error: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval, inside the parameter's bounds."""
    low, high = interval(value, error)
    return max(low, parameter.low), min(high, parameter.high)
