"""Within what bounds a number of the rig is held that a fit moved further than any data sheet allows.

Parts of a quantity are held together: a healthy valve is late by so much, however that is shared between waiting and following. A fit
has bounds of single numbers alone, so the quantity is shared out in a few ways, the first nearly as it was.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import FreeParameter, Values
from exo_sim.diagnosis.policy.off_nominal import HELD_WITHIN
from exo_sim.diagnosis.policy.verdicts import AT_BOUND
from exo_sim.diagnosis.selection.quantity_parts import Limits, parts_of, quantity_of, together, weights_of

#: Share of what is healthy that every part may have at least: bounds that meet leave a difference quotient no room.
_LEAST_SHARE = 0.05


@dataclass(frozen=True)
class Held:
    """One way to hold some numbers.

    Attributes:
        bounded: By number as a fit had it free, the same within its bounds.
        limits: How much of it is healthy, of each quantity whose parts are held together.
    """

    bounded: Mapping[FreeParameter, FreeParameter]
    limits: Limits

    def is_at_end(self, free: Collection[FreeParameter], values: Values) -> bool:
        """Return whether what is held would go on beyond its bounds; parts of a quantity where together they are all that is healthy.

        Args:
            free: Of the bounded numbers those that count.
            values: Of a fit with them.
        """
        alone = any(is_at_end(q, values[q]) for q in free if quantity_of(q) not in self.limits)
        return alone or any(
            together(parts_of(quantity, free), values) > (1.0 - AT_BOUND) * limit for quantity, limit in self.limits.items()
        )


def is_at_end(q: FreeParameter, value: float) -> bool:
    """Return whether a nuisance parameter ended at a bound beyond which it would go on, away from what is believed."""
    if q.prior is None:
        return False
    mean, spread = q.prior
    near = AT_BOUND * spread
    return (value - q.low < near and q.low < mean) or (q.high - value < near and q.high > mean)


def ways_to_hold(
    pressed: Sequence[FreeParameter], values: Values, covariance: NDArray[np.float64], limits: Limits
) -> tuple[Held, ...]:
    """Return the ways to hold numbers within their data sheets, and parts of a quantity within what is healthy of it, at each place.

    A quantity that is more is shared out as a quadratic of the fit would, which is nearly where the best fit on that bound lies, and so
    that each part in turn has as much as it may.

    Args:
        pressed: The numbers.
        values: Of the fit that moved them.
        covariance: Of these numbers in that fit, each in its unit, shape (pressed, pressed).
        limits: What is healthy of quantities.
    """
    sheet = {q: _within_data_sheet(q) for q in pressed}
    shares: list[list[dict[FreeParameter, float]]] = []
    more: dict[tuple[str, str, str], float] = {}
    for quantity, limit in limits.items():
        parts = parts_of(quantity, pressed)
        if len(parts) > 1 and together(parts, values) > limit:
            own = [pressed.index(q) for q in parts]
            nearest = _nearest(parts, values, covariance[np.ix_(own, own)], limit)
            most = {q: max(abs(sheet[q].low - q.neutral), abs(sheet[q].high - q.neutral)) for q in parts}
            shares.append([nearest, *(_with_most_of(q, parts, min(most[q], limit), limit) for q in parts)])
            more[quantity] = limit
    count = max((len(one) for one in shares), default=1)
    ways = []
    for number in range(count):
        most_of = {q: most for one in shares for q, most in one[min(number, len(one) - 1)].items()}
        bounded = {q: _within(held, most_of[q]) if q in most_of else held for q, held in sheet.items()}
        ways.append(Held(bounded, more))
    return tuple(ways)


def _nearest(
    parts: Sequence[FreeParameter], values: Values, covariance: NDArray[np.float64], limit: float
) -> dict[FreeParameter, float]:
    """Return how much of a quantity each part has where together they are the limit and a quadratic of the fit leaves least."""
    weights = np.array(list(weights_of(parts, values).values()))
    sizes = np.array([abs(values[q] - q.neutral) for q in parts])
    follow = weights * (covariance @ weights)
    beyond = sizes.sum() - limit
    moved = sizes - follow * beyond / follow.sum() if follow.sum() > 0.0 else sizes * limit / sizes.sum()
    kept = np.maximum(moved, _LEAST_SHARE * limit)
    return dict(zip(parts, map(float, kept * limit / kept.sum()), strict=True))


def _with_most_of(first: FreeParameter, parts: Sequence[FreeParameter], most: float, limit: float) -> dict[FreeParameter, float]:
    """Return how much of a quantity each part has where one has the most that it may, and the others the rest alike."""
    rest = max((limit - most) / (len(parts) - 1), _LEAST_SHARE * limit)
    return {q: limit - rest * (len(parts) - 1) if q == first else rest for q in parts}


def _within_data_sheet(q: FreeParameter) -> FreeParameter:
    if q.prior is None:
        return q
    mean, spread = q.prior
    return _between(q, mean - HELD_WITHIN * spread, mean + HELD_WITHIN * spread)


def _within(q: FreeParameter, most: float) -> FreeParameter:
    return _between(q, q.neutral - most, q.neutral + most)


def _between(q: FreeParameter, low: float, high: float) -> FreeParameter:
    return replace(q, low=max(q.low, low), high=min(q.high, high))
