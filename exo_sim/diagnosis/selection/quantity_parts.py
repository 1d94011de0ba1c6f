"""Parts of one quantity, such as dead time and time constant of a lag: how much they are together, and how much is healthy.

A fit shares a quantity out as noise happens to say: only the sum is well known.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Values

#: Effect, place and unit: numbers of another unit shape the law and are no part of how much of it there is.
Quantity = tuple[str, str, str]
#: How much of a quantity a healthy machine shows.
Limits = Mapping[Quantity, float]


def quantity_of(q: FreeParameter) -> Quantity:
    """Return the quantity that a parameter is a part of."""
    return q.effect, q.where, q.unit


def parts_of(quantity: Quantity, parameters: Iterable[FreeParameter]) -> tuple[FreeParameter, ...]:
    """Return the parts of a quantity among parameters; of two that stand for the same number the later."""
    return tuple({q.slot: q for q in parameters if quantity_of(q) == quantity}.values())


def together(parts: Sequence[FreeParameter], values: Values) -> float:
    """Return how far parts of a quantity are from neutral together, in its unit."""
    return sum(abs(values[q] - q.neutral) for q in parts)


def weights_of(parts: Sequence[FreeParameter], values: Values) -> dict[FreeParameter, float]:
    """Return by how much each part adds to what they are together, per unit of it: 1, or -1 below neutral."""
    return {q: math.copysign(1.0, values[q] - q.neutral) for q in parts}


def healthy_limits(candidates: Sequence[Candidate]) -> Limits:
    """Return how much a healthy machine shows of each quantity of which candidates hold parts."""
    limits: dict[Quantity, float] = {}
    for q in (q for c in candidates if c.additive for q in c.parameters if q.healthy_limit > 0.0):
        limits[quantity_of(q)] = max(limits.get(quantity_of(q), 0.0), q.healthy_limit)
    return limits
