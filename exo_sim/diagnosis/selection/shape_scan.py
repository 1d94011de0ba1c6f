"""Where a fit of an effect begins whose answer is not in proportion to its size: sought over a grid of shapes.

How a hose delays and rings is of its length: a fit that begins a quarter of it away ends in another optimum, and the error where it begins
does not tell which start is near. So each shape is put in as it is, all else that is free is refitted along its known derivatives, and what
is left then is compared: the variable projection of Golub and Pereyra (1973, doi 10.1137/0710036), on a grid.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.selection.cleared import Cleared
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel


def best_shapes(
    model: LeastSquaresModel, now: FittedModel, candidates: Iterable[Candidate], threads: Threads = SERIAL, is_spent: IsSpent = never
) -> list[tuple[float, FittedModel]]:
    """Return, of the candidates with shapes that promise a drop, that drop and where a fit begins; arguments as of `best_shape`."""
    found = (best_shape(model, now, one, threads, is_spent) for one in candidates if one.shapes)
    return [one for one in found if one is not None]


def best_shape(
    model: LeastSquaresModel, now: FittedModel, candidate: Candidate, threads: Threads = SERIAL, is_spent: IsSpent = never
) -> tuple[float, FittedModel] | None:
    """Return the drop in squared error that the best shape of a candidate promises, and where a fit with it begins; None where none does.

    What an owner may have counted it in begins smaller by as much.

    Args:
        model: The subsystem.
        now: A fitted model without the candidate.
        candidate: With `shapes`.
        threads: Threads for the predictions.
        is_spent: Whether the time is up: then nothing is looked at.
    """
    beyond = Cleared.of(now.fit, {q.slot for q in candidate.parameters})
    before = float(beyond.left @ beyond.left)
    fixed = [*now.fixed, *candidate.fixed]
    begun = [
        candidate.beside({**now.fit.values, **dict(zip(candidate.parameters, shape, strict=True))}) for shape in candidate.shapes
    ]

    def left(values: dict[FreeParameter, float]) -> float:
        if is_spent():
            return math.inf
        change = model.residual(values, fixed) - now.fit.residual
        if not np.isfinite(change).all():
            return math.inf
        whole = beyond.left + beyond.clear(change)
        return float(whole @ whole)

    each = threads.predictions(left, begun)
    best = int(np.argmin(each))
    if not each[best] < before:
        return None
    return before - each[best], FittedModel((*now.candidates, candidate), replace(now.fit, values=begun[best]))
