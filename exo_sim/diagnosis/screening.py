"""The screen: each candidate's signature, cleared of what the fitted numbers can explain, held against what is left over."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitted_set import Problem, Trial
from exo_sim.diagnosis.fitting import prior_terms
from exo_sim.diagnosis.quantity import Candidate, Quantity
from exo_sim.diagnosis.threads import ALONE, Threads

Array = NDArray[np.float64]


def screen(
    problem: Problem, now: Trial, questions: Sequence[Candidate], threads: Threads = ALONE
) -> list[tuple[float, Candidate]]:
    """Return the candidates that are not in a trial by how much of its error their signatures could explain, best first."""
    base = now.fit.residual
    fixed_now = now.fixed
    prior_rows, prior_jac = prior_terms(now.fit.quantities, now.fit.values)
    strength = math.sqrt(now.fit.weight)
    whole = np.vstack([now.fit.jacobian, strength * prior_jac])
    raw = np.concatenate([base, strength * prior_rows])
    values = now.fit.values
    loose = [j for j, q in enumerate(now.fit.quantities) if q.low < values[q] < q.high]
    cleared: dict[tuple[int, ...], tuple[Array, Array]] = {}

    def clear_of(candidate: Candidate) -> tuple[Array, Array]:
        """Return a basis of what the fitted numbers can explain, those that the candidate stands for left out, and the rest."""
        fields = {q.field for q in candidate.quantities}
        columns = tuple(j for j in loose if now.fit.quantities[j].field not in fields)
        if columns not in cleared:
            basis = np.linalg.qr(whole[:, columns])[0] if columns else np.zeros((whole.shape[0], 0))
            cleared[columns] = basis, raw - basis @ (basis.T @ raw)
        return cleared[columns]

    level = math.sqrt(float(base @ base) / max(base.size, 1))

    def score(candidate: Candidate) -> tuple[float, Candidate]:
        best = 0.0
        basis, target = clear_of(candidate)
        for start in candidate.starts:
            change = _answer(problem, candidate, start, now, fixed_now, base, level)
            if change is None:
                continue
            clear = np.concatenate([change, np.zeros(len(prior_rows))])
            clear -= basis @ (basis.T @ clear)
            power = float(clear @ clear)
            pull = -float(clear @ target)
            if power <= 1e-12 * float(change @ change) or power == 0.0:
                continue
            taken = {q.field for q in now.fit.quantities}
            one_sided = all(q.low >= q.neutral and q.field not in taken for q in candidate.quantities)
            if pull <= 0.0 and one_sided:
                continue
            best = max(best, pull * pull / power)
        return best, candidate

    open_questions = [c for c in questions if (c.effect, c.where) not in now.keys and now.bears(c)]
    scored = threads.predictions(score, open_questions)
    return sorted(scored, key=lambda pair: -pair[0])


def _answer(
    problem: Problem,
    candidate: Candidate,
    start: tuple[float, ...],
    now: Trial,
    fixed_now: list[tuple[Quantity, float]],
    base: Array,
    level: float,
) -> Array | None:
    """Return how the residual changes when the candidate is put in at a size that shows but does not swamp."""
    size = 1.0
    for _ in range(4 if candidate.proportional else 1):
        values = {
            q: float(np.clip(q.neutral + size * (v - q.neutral), q.low, q.high))
            for q, v in zip(candidate.quantities, start, strict=True)
        }
        change = problem.residual({**now.fit.values, **values}, [*fixed_now, *candidate.fixed]) - base
        if not np.isfinite(change).all():
            return None
        strength = math.sqrt(float(change @ change) / change.size)
        if strength > 10.0 * level and size > 1e-3:
            size *= 0.2
        elif strength < 0.02 * level and size < 50.0:
            size *= 10.0
        else:
            break
    return change
