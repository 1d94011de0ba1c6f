"""What is believed of free parameters before any data, as residuals of a least-squares fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import FreeParameter

Array = NDArray[np.float64]


def prior_terms(parameters: Sequence[FreeParameter], values: Mapping[FreeParameter, float]) -> tuple[Array, Array]:
    """Return the residuals of the priors, shape (m,), and their Jacobian in coordinates, shape (m, p).

    A number in which an owner may have counted another that is free here is held against what he believes with it and without, whichever
    is nearer: with a hose in the model, a dead volume may be as much smaller than his.
    """
    counted = _counted(parameters, values)
    rows, jac = [], []
    for j, parameter in enumerate(parameters):
        if parameter.prior is not None:
            mean, spread = parameter.prior
            away = values[parameter] - mean
            row = np.zeros(len(parameters))
            row[j] = parameter.slope(values[parameter]) / spread
            shares = counted.get(parameter.key, {})
            with_them = away + sum(share * values[parameters[k]] for k, share in shares.items())
            if abs(with_them) < abs(away):
                away = with_them
                for k, share in shares.items():
                    row[k] = share * parameters[k].slope(values[parameters[k]]) / spread
            rows.append(away / spread)
            jac.append(row)
    return np.array(rows), np.array(jac).reshape(len(rows), len(parameters))


def as_counted(parameter: FreeParameter, values: Mapping[FreeParameter, float]) -> float:
    """Return a nuisance parameter as its owner would have counted it: with what else is free that he may have counted in, or without.

    Args:
        parameter: One with a prior.
        values: Of all that is free.
    """
    value, mean = values[parameter], parameter.prior[0] if parameter.prior else parameter.neutral
    whole = value + sum(share * values[own] for own in values for key, share in own.displaces if key == parameter.key)
    return min(value, whole, key=lambda one: abs(one - mean))


def _counted(parameters: Sequence[FreeParameter], values: Mapping[FreeParameter, float]) -> dict[tuple[str, str, str], dict[int, float]]:
    """Return what may be counted in which nuisance parameter: positions of parameters, and their shares of its unit."""
    found: dict[tuple[str, str, str], dict[int, float]] = {}
    for k, own in enumerate(parameters):
        for key, share in own.displaces:
            found.setdefault(key, {})[k] = share
    return found
