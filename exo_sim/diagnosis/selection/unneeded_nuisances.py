"""Imperfections that a healthy machine may have and that no data show: the accepted model does without them.

Edges of a valve, its offset and lag, zeros and delays of sensors are free in every fit, so that what is said of anything else holds
whatever they are. Their estimates scatter all the same, by their standard errors and by what the laws of every model get wrong, and a
machine that runs free adds that up: an edge that is 0.2 % too wide moves a piston that nothing holds by millimetres. By Akaike's criterion
a parameter that gains less than one unit of log-likelihood predicts worse than its nominal value.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.uncertainty import covariance
from exo_sim.diagnosis.nominal_numbers import ZERO
from exo_sim.diagnosis.policy.acceptance import NEEDED
from exo_sim.diagnosis.policy.healthy import ZERO_MODEL
from exo_sim.diagnosis.policy.off_nominal import MODEL_SHARE
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.physics.declaration import identification_of

Array = NDArray[np.float64]


def without_unneeded(fits: ModelFits, model: FittedModel, structural: float = 0.0) -> FittedModel:
    """Return a model with the imperfections that its data do not show at zero, and the rest fitted to that.

    How uncertain its numbers are stays what it was: that an imperfection was left out says nothing of it being absent.

    Args:
        fits: Fits of the models of its subsystem.
        model: Fitted to convergence, with its Jacobian.
        structural: As of `error_of_model`.
    """
    unneeded = unneeded_of(fits, model, structural)
    if not unneeded or fits.is_spent():
        return model
    rest = fits.refitted_without(model, unneeded)
    values = {q: 0.0 if q in unneeded else rest.values[q] for q in model.fit.parameters}
    return replace(model, fit=replace(model.fit, values=values, residual=rest.residual, penalty=rest.penalty))


def unneeded_of(fits: ModelFits, model: FittedModel, structural: float = 0.0) -> frozenset[FreeParameter]:
    """Return the imperfections that gain too little for their number, one effect at a place after the other, the least needed first.

    Arguments as of `without_unneeded`.
    """
    parameters = list(model.fit.parameters)
    spread = covariance(model.fit, fits.correlation_time(model.fit.residual))
    spread = spread + np.diag([error_of_model(q, structural) ** 2 / q.scale**2 for q in parameters])
    offset = np.array([q.coordinate(model.fit.values[q]) if not q.logarithmic else 0.0 for q in parameters])
    groups: dict[tuple[str, str], list[int]] = {}
    effects = {candidate.at for candidate in model.candidates}
    for j, q in enumerate(parameters):
        if q in fits.nuisances and is_imperfection(q) and (q.effect, q.where) not in effects:
            groups.setdefault((q.effect, q.where), []).append(j)
    gone: list[int] = []
    while groups:
        gains = {key: _gain(offset[own], spread[np.ix_(own, own)]) / len(own) for key, own in groups.items()}
        least = min(gains, key=lambda key: gains[key])
        if gains[least] >= NEEDED:
            break
        own = groups.pop(least)
        pull = spread[:, own] @ np.linalg.pinv(spread[np.ix_(own, own)], hermitian=True)
        offset = offset - pull @ offset[own]
        spread = spread - pull @ spread[own, :]
        gone += own
    return frozenset(parameters[j] for j in gone)


def is_imperfection(parameter: FreeParameter) -> bool:
    """Return whether a nuisance parameter is something that a perfect machine would not have."""
    return parameter.prior is not None and parameter.prior[0] == 0.0 and parameter.neutral == 0.0 and not parameter.logarithmic


def error_of_model(parameter: FreeParameter, structural: float) -> float:
    """Return the standard deviation by which what no model has right moves an imperfection, in its unit.

    Args:
        parameter: The imperfection.
        structural: Largest error of a healthy machine's model in the unit of the subsystem.
    """
    if parameter.effect == ZERO:
        return ZERO_MODEL * structural
    _, shares = identification_of(parameter.effect).multiplies  # of an area; a place on the command's scale is no flow
    return float(MODEL_SHARE) if parameter.parameter in shares else 0.0


def _gain(offset: Array, spread: Array) -> float:
    """Return by how much -2 log of the posterior rises where these coordinates are set to zero (Wald's statistic)."""
    return float(offset @ np.linalg.pinv(spread, hermitian=True) @ offset)
