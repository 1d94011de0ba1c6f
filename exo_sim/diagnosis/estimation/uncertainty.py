"""How well a fit knows its parameters: standard errors and 95 % intervals that are robust to correlated residuals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.correlation import Blocked
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter

Array = NDArray[np.float64]

#: Standard errors from the middle of a 95 % interval to its ends: the 97.5 % quantile of the normal distribution.
HALF_WIDTH = 1.959963984540054


def standard_errors(rows: Blocked, fit: Fit, correlation_time: float) -> dict[FreeParameter, float]:
    """Return the standard error of every fitted parameter, in its unit.

    The larger of two: least squares with the residual's own variance and correlation time, and the jackknife over blocks of time (CR3 of
    MacKinnon, Nielsen and Webb 2023), which also holds for a misspecified model with correlated residuals, and for few blocks.

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
    left_out = _jackknife(rows.blocks, jac, fit.residual, information + prior.T @ prior)
    found = {}
    for j, parameter in enumerate(fit.parameters):
        both = max(float(bread[j, j]), float(left_out[j]), 0.0)
        found[parameter] = math.sqrt(both) * abs(parameter.slope(fit.values[parameter]))
    return found


def _jackknife(blocks: NDArray[np.int64], jac: Array, residual: Array, information: Array) -> Array:
    """Return the variance of each parameter by leaving out one block of rows after the other, shape (parameters,).

    One Gauss-Newton step without a block, with A the information of all rows and of the priors, is (A - J_b' J_b)^-1 J_b' r_b: unlike the
    residuals themselves it does not shrink where a block holds a parameter down by itself.

    Args:
        blocks: Block of each row, shape (n,).
        jac, residual: Of the fit, shapes (n, parameters) and (n,).
        information: A, shape (parameters, parameters).
    """
    order = np.argsort(blocks, kind="stable")
    ends = np.flatnonzero(np.diff(blocks[order])) + 1
    steps = []
    for own in np.split(order, ends):
        part = jac[own]
        steps.append(np.linalg.pinv(information - part.T @ part, hermitian=True) @ (part.T @ residual[own]))
    count = len(steps)
    if count < 2:
        return np.zeros(jac.shape[1])
    moved = np.array(steps)
    return np.asarray((count - 1) / count * np.sum(moved**2, axis=0))


def interval(value: float, error: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a number without bounds, given its standard error."""
    return value - HALF_WIDTH * error, value + HALF_WIDTH * error


def bounded_interval(parameter: FreeParameter, value: float, error: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval, inside the parameter's bounds."""
    low, high = interval(value, error)
    return max(low, parameter.low), min(high, parameter.high)
