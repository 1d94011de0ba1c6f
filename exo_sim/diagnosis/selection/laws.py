"""Laws that effects may follow and that explain a recording about as well: what they leave open of each number."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.selection.fitted_model import FittedModel


@dataclass(frozen=True)
class Law:
    """One law that the effects of a subset may follow.

    Attributes:
        weight: Its probability in units of the most probable one's.
        own: Whether it is the best subset's own.
        values, errors: Parameters and their posterior standard deviations.
    """

    weight: float
    own: bool
    values: Mapping[FreeParameter, float]
    errors: Mapping[FreeParameter, float]


def errors_about(final: FittedModel, laws: Sequence[Law], side: int = 0) -> dict[FreeParameter, float]:
    """Return standard deviations about the values of a model, over all laws that its effects may follow.

    Laws that fit about as well give a number other values (a dip that falls slowly with speed leaves less to the level at which a
    contact slides), and so does another effect beside it that explains the rest as well: the mean square over them, by their
    probability, is what is not known of it.

    Args:
        final: The model.
        laws: Those that fit about as well.
        side: -1 or 1 where only laws count whose value is lower or higher: how far a dip rises towards rest may be quite unknown, and that
            there is one beyond doubt. 0 for all of them.
    """
    weights: dict[FreeParameter, list[tuple[float, float]]] = {}
    for law in laws:
        for q, error in law.errors.items():
            if q in final.effect_parameters and (law.own or q.target is not Target.SENSOR):  # a sensor's error has one law
                away = law.values[q] - final.fit.values[q]
                counts = away if side * away >= 0.0 else 0.0
                weights.setdefault(q, []).append((law.weight, error**2 + counts**2))
    return {q: math.sqrt(sum(w * square for w, square in pairs) / sum(w for w, _ in pairs)) for q, pairs in weights.items()}
