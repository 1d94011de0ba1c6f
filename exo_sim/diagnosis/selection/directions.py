"""Directions in which a joint proposal may go: the signatures of candidates beside a fitted model, one for each size or amount."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.budget import IsSpent
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.threads import Threads
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel
from exo_sim.diagnosis.selection.score_test import Sizes, law_signatures, signature, spread_of

Array = NDArray[np.float64]

#: Amplitude, in units of the signature's size, that a linear answer is followed to at most.
FURTHEST = 4.0
#: Amplitude, in the same units, from which a fit begins at least: at nil some effects do not answer, and a size that is bounded there
#: cannot begin below. Of 30 amplitudes of two benches (a leak beside wall heat, a dead-band beside a lag) it raised 6, to a law whose
#: share the linear answer puts at 0.09 or below nil; two legs and two real machines of forces proposed nothing together.
LEAST = 0.2


@dataclass(frozen=True)
class Direction:
    """One candidate at one size.

    Attributes:
        candidate: The candidate.
        sizes: Its parameters at amplitude 1, and at 0.
        columns: Change of the residual, shape (n, c): one column for a size as a whole, or one for each parameter where they count apart.
        one_sided: Whether a negative amplitude has no meaning.
    """

    candidate: Candidate
    sizes: dict[FreeParameter, tuple[float, float]]
    columns: Array
    one_sided: bool

    @property
    def _is_linear(self) -> bool:
        return self.candidate.proportional or self.columns.shape[1] > 1

    def values(self, amplitudes: Array) -> dict[FreeParameter, float]:
        """Return the parameters at these amplitudes, shape (c,)."""
        found = {}
        for j, (q, (one, nil)) in enumerate(self.sizes.items()):
            a = float(amplitudes[j if len(amplitudes) > 1 else 0])
            a = min(max(a, -FURTHEST), FURTHEST)
            if not self.candidate.is_law:
                a = max(a, LEAST) if self.one_sided else (a if abs(a) > LEAST else math.copysign(LEAST, a))
            value = nil + a * (one - nil) if self._is_linear else one
            found[q] = min(max(value, q.low), q.high)
        return found


def directions(
    model: LeastSquaresModel, now: FittedModel, candidates: Sequence[Candidate], threads: Threads, is_spent: IsSpent, known: Sizes
) -> list[Direction]:
    """Return the directions of all candidates that can be predicted, but of faults of sensors and of effects that the model has.

    Args:
        model: The subsystem.
        now: The fitted model.
        candidates: All candidates.
        threads: Threads for the predictions.
        is_spent: Whether the time is up: then nothing more is predicted.
        known: At which share of their size signatures stood out of the noise before; what is found here is added.
    """
    base, fixed = now.fit.residual, now.fixed
    level = math.sqrt(float(base @ base) / max(base.size, 1))
    left = [one for one in candidates if one.kind is not Kind.SENSOR and one.at not in now.named]
    apart = [one for one in left if one.is_law or _count_apart(one)]
    asked: list[tuple[Candidate, tuple[float, ...] | None]] = []
    for one in left:
        if one in apart:
            asked.append((one, None))
        elif not any(other.at == one.at and set(one.parameters) < set(other.parameters) for other in apart):
            asked += [(one, start) for start in one.starts]

    def direction(pair: tuple[Candidate, tuple[float, ...] | None]) -> Direction | None:
        one, start = pair
        if is_spent():
            return None
        if one.is_law:
            columns = law_signatures(model, one, now, fixed)
            sizes = {q: (q.start + spread_of(q), q.start) for q in one.parameters}
            return Direction(one, sizes, columns, False) if np.isfinite(columns).all() else None
        one_sided = not one.proportional or all(q.low >= q.neutral for q in one.parameters)
        starts = [start] if start is not None else _one_by_one(one)
        found = [signature(model, one, each, now, fixed, base, level, known) for each in starts]
        changes = [pair for pair in found if pair is not None and float(pair[0] @ pair[0]) > 0.0]
        if not changes or len(changes) < len(found):
            return None
        sizes = {q: (max(values[q] for _, values in changes), q.neutral) for q in one.parameters}
        return Direction(one, sizes, np.column_stack([change for change, _ in changes]), one_sided)

    return [one for one in threads.predictions(direction, asked) if one is not None]


def _count_apart(candidate: Candidate) -> bool:
    """Return whether each parameter of a candidate is an amount of its own, nil where the effect is absent."""
    return len(candidate.parameters) > 1 and all(q.neutral == q.low == 0.0 and not q.logarithmic for q in candidate.parameters)


def _one_by_one(candidate: Candidate) -> list[tuple[float, ...]]:
    """Return sizes with one parameter each at its typical value and the others at nil."""
    first = candidate.starts[0]
    return [tuple(value if j == k else 0.0 for j, value in enumerate(first)) for k in range(len(first))]
