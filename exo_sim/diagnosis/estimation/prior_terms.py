"""The priors of free parameters, as residuals of a least-squares fit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import FreeParameter

Array = NDArray[np.float64]


def prior_terms(parameters: Sequence[FreeParameter], values: Mapping[FreeParameter, float]) -> tuple[Array, Array]:
    """Return the residuals of the priors, shape (m,), and their Jacobian in coordinates, shape (m, p).

    A number in which an owner may have counted another that is free here is held against what he believes with it and without, whichever
    is nearer: with a hose in the model, a dead volume may be as much smaller than his.
    """
    owners = [q for q in parameters if q.displaces]
    rows, jac = [], []
    for j, parameter in enumerate(parameters):
        if parameter.prior is not None:
            mean, spread = parameter.prior
            shares = _counted_in(parameter, values, owners)
            row = np.zeros(len(parameters))
            row[j] = parameter.slope(values[parameter]) / spread
            for own, share in shares.items():
                row[parameters.index(own)] = share * own.slope(values[own]) / spread
            rows.append((values[parameter] - mean + _sum(shares, values)) / spread)
            jac.append(row)
    return np.array(rows), np.array(jac).reshape(len(rows), len(parameters))


def as_counted(parameter: FreeParameter, values: Mapping[FreeParameter, float]) -> float:
    """Return a nuisance parameter as its owner would have counted it: with what else is free that he may have counted in, or without.

    Args:
        parameter: One with a prior.
        values: Of all that is free.
    """
    return values[parameter] + _sum(_counted_in(parameter, values, values), values)


def _counted_in(
    parameter: FreeParameter, values: Mapping[FreeParameter, float], owners: Iterable[FreeParameter]
) -> dict[FreeParameter, float]:
    """Return of which free parameters what share is counted in a nuisance parameter: of none where it is nearer to belief without them."""
    shares = {own: share for own in owners for key, share in own.displaces if key == parameter.key}
    away = values[parameter] - parameter.start
    return shares if abs(away + _sum(shares, values)) < abs(away) else {}


def _sum(shares: Mapping[FreeParameter, float], values: Mapping[FreeParameter, float]) -> float:
    return sum(share * values[own] for own, share in shares.items())
