"""What a fit leaves beside a discrepancy whose spread is known: the laws of effects that the rig has are wrong by so much."""

from __future__ import annotations

import math

import numpy as np

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.least_squares import Fit


def left_beside(fit: Fit, basis: DiscrepancyBasis, row_variance: float) -> float:
    """Return the root mean square residual that is left beside a discrepancy [units of the noise of a row].

    With D the columns of the discrepancy, H their prior variances, J and P the fitted numbers' responses and the variances of their
    priors, and s the variance of a row, it is sqrt(s r'(s I + D H D' + J P J')^(-1) r / n): what neither explains, and what it costs them
    to explain the rest. The numbers move about where the fit left them. Without a discrepancy it is the residual as it is.

    Args:
        fit: Of n rows.
        basis: Of the discrepancy.
        row_variance: Variance of a row, its correlation with others and the errors of a healthy machine included.
    """
    residual, columns = fit.residual, basis.columns
    if not residual.size or not columns.shape[1]:
        return math.sqrt(float(residual @ residual) / max(residual.size, 1))
    scaled = columns * basis.healthy[basis.kinds]
    prior = fit.prior_jacobian.reshape(len(fit.prior_jacobian), len(fit.parameters))
    cost = np.zeros((len(prior) + scaled.shape[1], len(fit.parameters) + scaled.shape[1]))
    cost[: len(prior), : len(fit.parameters)] = prior
    cost[len(prior) :, len(fit.parameters) :] = np.eye(scaled.shape[1])
    rows = np.vstack([np.hstack([fit.jacobian, scaled]), math.sqrt(row_variance) * cost])
    aimed = np.concatenate([residual, np.zeros(len(cost))])
    moves = np.linalg.lstsq(rows, -aimed, rcond=None)[0]
    left = aimed + rows @ moves
    return math.sqrt(float(left @ left) / residual.size)
