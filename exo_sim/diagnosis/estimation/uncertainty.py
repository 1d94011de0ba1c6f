"""How well a fit knows its parameters: standard errors and 95 % intervals that are robust to correlated residuals."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.correlation import Blocked
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter

Array = NDArray[np.float64]

#: Standard errors from the middle of a 95 % interval to its ends: the 97.5 % quantile of the normal distribution.
HALF_WIDTH = 1.959963984540054
#: Share of a direction that a block of rows determines, or leaves to others, below which it counts as none or as all: rounding.
_LEAST_PULL = 1e-9


def standard_errors(rows: Blocked, fit: Fit, correlation_time: float) -> dict[FreeParameter, float]:
    """Return the standard error of every fitted parameter, in its unit.

    The larger of two: least squares with the residual's own variance and correlation time, and the sandwich estimator clustered by
    blocks of time with the correction of Bell and McCaffrey (2002) for few blocks (CR2), which also holds for a misspecified model with
    correlated residuals. In both a row counts as little as its residual's variance and correlation leave of it: priors then hold what
    rows that are missed by tens of standard deviations do not.

    Args:
        rows: Whose rows they are.
        fit: The fit.
        correlation_time: Of its residual, in rows.
    """
    if not fit.parameters or not fit.residual.size:
        return {}
    bread, (of_blocks, of_priors) = covariance(fit, correlation_time), _scores(rows.blocks, fit, correlation_time)
    clustered = np.sum(np.square(of_blocks), axis=0) + np.sum(np.square(of_priors), axis=0)
    found = {}
    for j, parameter in enumerate(fit.parameters):
        both = max(float(bread[j, j]), float(clustered[j]), 0.0)
        found[parameter] = math.sqrt(both) * abs(parameter.slope(fit.values[parameter]))
    return found


def error_of_sum(rows: Blocked, fit: Fit, correlation_time: float, weights: Mapping[FreeParameter, float]) -> float:
    """Return the standard error of a weighted sum of fitted parameters, also where it is known far better than each of them.

    Args:
        rows, fit, correlation_time: As of `standard_errors`.
        weights: Of some of the fitted parameters; infinite is the error where one of them was not fitted.
    """
    if not set(weights) <= set(fit.parameters) or not fit.residual.size:
        return math.inf
    weighed = np.array([weights.get(q, 0.0) * q.slope(fit.values[q]) for q in fit.parameters])
    plain = float(weighed @ covariance(fit, correlation_time) @ weighed)
    of_blocks, of_priors = (one @ weighed for one in _scores(rows.blocks, fit, correlation_time))
    return math.sqrt(max(plain, float(of_blocks @ of_blocks + of_priors @ of_priors), 0.0))


def covariance(fit: Fit, correlation_time: float) -> Array:
    """Return the covariance of the coordinates of the fitted parameters by least squares, shape (parameters, parameters).

    Args:
        fit: The fit, with the residual's own variance where that is more than the noise.
        correlation_time: Of its residual, in rows.
    """
    if not fit.parameters:
        return np.zeros((0, 0))
    prior = fit.prior_jacobian.reshape(-1, len(fit.parameters))
    return np.asarray(np.linalg.pinv(fit.jacobian.T @ fit.jacobian / _inflation(fit, correlation_time) + prior.T @ prior))


def _inflation(fit: Fit, correlation_time: float) -> float:
    """Return by how much the variance of a row's score exceeds that of noise alone: the residual's variance and correlation, 1 or more."""
    return max(fit.sse / max(fit.residual.size - len(fit.parameters), 1), 1.0) * max(correlation_time, 1.0)


def _scores(blocks: NDArray[np.int64], fit: Fit, correlation_time: float) -> tuple[Array, Array]:
    """Return by how much each block of time, and each prior, moves the coordinates, shapes (blocks, parameters) and (priors, parameters).

    The sum of their squares is the variance of a coordinate, or of a sum of coordinates. With A the information of all rows and of the
    priors, and H_b = J_b A^-1 J_b' what a block of rows pulls the fit towards itself, its residual counts as (I - H_b)^(-1/2) r_b: where
    rows are independent the variance is then unbiased, however few blocks there are. To leave out one block after the other says nothing
    of a number that one block alone holds down. What a prior takes part in is as uncertain as the prior's mean.

    Args:
        blocks: Block of each row, shape (n,).
        fit: The fit.
        correlation_time: Of its residual, in rows.
    """
    root_of_inflation = math.sqrt(_inflation(fit, correlation_time))
    jac, residual = fit.jacobian / root_of_inflation, fit.residual / root_of_inflation
    prior = fit.prior_jacobian.reshape(-1, len(fit.parameters))
    information = jac.T @ jac + prior.T @ prior
    order = np.argsort(blocks, kind="stable")
    ends = np.flatnonzero(np.diff(blocks[order])) + 1
    inverse = np.linalg.pinv(information, hermitian=True)
    sizes, axes = np.linalg.eigh(inverse)
    root = axes * np.sqrt(np.maximum(sizes, 0.0))
    scores = []
    for own in np.split(order, ends):
        part, left = jac[own] @ root, residual[own]
        pulls, directions = np.linalg.eigh(part.T @ part)
        score = part.T @ left
        widened = np.where((pulls > _LEAST_PULL) & (pulls < 1.0 - _LEAST_PULL), 1.0 / np.sqrt(np.maximum(1.0 - pulls, _LEAST_PULL)), 1.0)
        scores.append(root @ (directions @ (widened * (directions.T @ score))))
    return np.asarray(scores), (inverse @ prior.T).T


def interval(value: float, error: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a number without bounds, given its standard error."""
    return value - HALF_WIDTH * error, value + HALF_WIDTH * error


def bounded_interval(parameter: FreeParameter, value: float, error: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval, inside the parameter's bounds.

    Of a throttle that of the inverse of its square, with which the drop of pressure goes: of one that is wide the recording says how wide
    it is at least.
    """
    low, high = interval(value, error)
    if parameter.saturates and value > 0.0:
        share = 2.0 * HALF_WIDTH * error / value
        low, high = value / math.sqrt(1.0 + share), value / math.sqrt(1.0 - share) if share < 1.0 else math.inf
    return max(low, parameter.low), min(high, parameter.high)
