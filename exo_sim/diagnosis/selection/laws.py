"""Laws that effects may follow and that explain a recording about as well: what they leave open of each number."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri

from exo_sim.diagnosis.estimation.candidate import CandidateKey
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.selection.fitted_model import FittedModel

Array = NDArray[np.float64]

#: Probability below a 95 % interval, and above it.
TAIL = float(ndtr(-HALF_WIDTH))


@dataclass(frozen=True)
class Law:
    """One law that the effects of a subset may follow.

    Attributes:
        weight: Its probability in units of the most probable one's.
        own: Whether it is the best subset's own.
        values, errors: Parameters and their posterior standard deviations.
        forms: The effects that are present under it, each with its form.
    """

    weight: float
    own: bool
    values: Mapping[FreeParameter, float]
    errors: Mapping[FreeParameter, float]
    forms: frozenset[CandidateKey] = frozenset()


def errors_about(final: FittedModel, laws: Sequence[Law]) -> dict[FreeParameter, float]:
    """Return standard deviations about the values of a model, over all laws that its effects may follow.

    Laws that fit about as well give a number other values (a dip that falls slowly with speed leaves less to the level at which a
    contact slides), and so does another effect beside it that explains the rest as well: the mean square over them, by their
    probability, is what is not known of it.

    Args:
        final: The model.
        laws: Those that fit about as well.
    """
    found = {}
    for q, posterior in _posteriors(final, laws).items():
        away = posterior.values - final.fit.values[q]
        found[q] = math.sqrt(float(posterior.weights @ (posterior.errors**2 + away**2)))
    return found


def reach_of_laws(final: FittedModel, laws: Sequence[Law]) -> dict[FreeParameter, tuple[float, float]]:
    """Return how far from the values of a model its laws' posterior reaches, towards lower and towards higher values.

    In standard errors: so many times `HALF_WIDTH` away are the 2.5 % and the 97.5 % quantile of the mixture of all laws. A law of a
    tenth of the probability lies within, far from the others as it may be; one on the far side alone says nothing of this one.
    """
    return {
        q: (
            max(final.fit.values[q] - posterior.quantile(TAIL), 0.0) / HALF_WIDTH,
            max(posterior.quantile(1.0 - TAIL) - final.fit.values[q], 0.0) / HALF_WIDTH,
        )
        for q, posterior in _posteriors(final, laws).items()
    }


def reaching(
    reach: Mapping[FreeParameter, tuple[float, float]], final: FittedModel, others: Sequence[Mapping[FreeParameter, tuple[float, float]]]
) -> dict[FreeParameter, tuple[float, float]]:
    """Return a reach, as far as what else explains the recording as well has the numbers.

    Args:
        reach: As of `reach_of_laws`.
        final: The model about whose values it is.
        others: The least and the greatest number that each would have instead.
    """
    found = dict(reach)
    for q, (low, high) in (pair for one in others for pair in one.items()):
        value, (below, above) = final.fit.values[q], found.get(q, (0.0, 0.0))
        found[q] = max(below, (value - low) / HALF_WIDTH), max(above, (high - value) / HALF_WIDTH)
    return found


@dataclass(frozen=True)
class _Mixture:
    """A mixture of normal distributions, one a law, shape (laws,) each; the weights sum to one."""

    weights: Array
    values: Array
    errors: Array

    def quantile(self, share: float) -> float:
        """Return the value below which so much of it lies."""
        spread = np.maximum(self.errors, 1e-12 * max(float(np.abs(self.values).max()), 1e-300))
        own = self.values + ndtri(share) * spread  # of each law: that of the mixture lies between them
        low, high = float(own.min()), float(own.max())
        if not low < high:
            return low
        return float(brentq(lambda x: float(self.weights @ ndtr((x - self.values) / spread)) - share, low, high, xtol=1e-9 * (high - low)))


def _posteriors(final: FittedModel, laws: Sequence[Law]) -> dict[FreeParameter, _Mixture]:
    """Return the posterior of each of a model's numbers, over all laws that its effects may follow."""
    found: dict[FreeParameter, list[tuple[float, float, float]]] = {}
    for law in laws:
        for q, error in law.errors.items():
            if q in final.effect_parameters and (law.own or q.target is not Target.SENSOR):  # a sensor's error has one law
                found.setdefault(q, []).append((law.weight, law.values[q], error))
    mixtures = {}
    for q, members in found.items():
        weights, values, errors = np.array(members).T
        mixtures[q] = _Mixture(weights / weights.sum(), values, errors)
    return mixtures
