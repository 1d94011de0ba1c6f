"""How a rival chooses among the columns of a regression."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.trials.rivals.files import Array
from exo_sim.trials.rivals.weak_form import Regression

#: A term must lower the held-out error by this share to stay.
SHARE = 0.03
#: A term whose part is smaller than this share of the whole is dropped by thresholding; columns and rest have unit length there.
SMALL = 0.15
#: An ensemble's models, and in what share of them a term must be.
MODELS, INCLUDED = 50, 0.6
#: Windows that are held out, or not, together.
BLOCK = 40


@dataclass(frozen=True)
class Chosen:
    """What was chosen of one column: its coefficient with standard error, and by what share it lowers the held-out error."""

    value: float
    error: float
    gained: float


@dataclass(frozen=True)
class Problem:
    """Columns of unit length, shape (n, columns), and what they are to explain, shape (n,)."""

    table: Array
    rest: Array

    def held_out_error(self, chosen: list[int]) -> float:
        """Return the rms of what is left in every other block of windows after a fit to the rest."""
        odd = held_out(len(self.rest))
        if not chosen:
            return float(np.sqrt(np.mean(self.rest[odd] ** 2)))
        fit = np.linalg.lstsq(self.table[~odd][:, chosen], self.rest[~odd], rcond=1e-8)[0]
        return float(np.sqrt(np.mean((self.rest[odd] - self.table[odd][:, chosen] @ fit) ** 2)))


def held_out(rows: int) -> NDArray[np.bool_]:
    """Return which windows are held out: every other block, shape (rows,)."""
    return np.asarray((np.arange(rows) // BLOCK) % 2 == 1)


def greedy(problem: Problem) -> list[int]:
    """Add the term that lowers the error most, as long as one does."""
    chosen: list[int] = []
    everything = range(problem.table.shape[1])
    while len(chosen) < len(everything):
        best = min((k for k in everything if k not in chosen), key=lambda k: problem.held_out_error([*chosen, k]))
        if problem.held_out_error([*chosen, best]) > (1 - SHARE) * problem.held_out_error(chosen):
            break
        chosen.append(best)
    return chosen


def prune(problem: Problem) -> list[int]:
    """Fit everything, and drop the term that is missed least until one is missed."""
    chosen = list(range(problem.table.shape[1]))
    while chosen:
        without = {k: problem.held_out_error([c for c in chosen if c != k]) for k in chosen}
        least = min(chosen, key=without.__getitem__)
        if without[least] > (1 + SHARE) * problem.held_out_error(chosen):
            break
        chosen.remove(least)
    return chosen


def threshold(problem: Problem) -> list[int]:
    """Drop small terms and fit again until none is small (sequentially thresholded least squares)."""
    chosen = list(range(problem.table.shape[1]))
    while chosen:
        fit = np.linalg.lstsq(problem.table[:, chosen], problem.rest, rcond=1e-8)[0]
        kept = [c for c, value in zip(chosen, fit) if abs(value) > SMALL * np.linalg.norm(problem.rest)]
        if len(kept) == len(chosen):
            break
        chosen = kept
    return chosen


def ensemble(problem: Problem) -> list[int]:
    """Keep what most of many thresholded fits keep, each to windows drawn anew (pysindy's ensemble; Fasel et al. 2022).

    The draws come from one seed.
    """
    from pysindy.optimizers import STLSQ, EnsembleOptimizer

    before = np.random.get_state()  # noqa: NPY002
    np.random.seed(0)  # noqa: NPY002 - pysindy draws its windows from numpy's own generator
    try:
        size = float(np.linalg.norm(problem.rest)) or 1.0
        optimizer = EnsembleOptimizer(STLSQ(threshold=SMALL, alpha=1e-8), bagging=True, n_models=MODELS)
        optimizer.fit(problem.table, problem.rest[:, None] / size)
    finally:
        np.random.set_state(before)  # noqa: NPY002
    kept = np.mean([np.abs(np.ravel(one)) > 0.0 for one in optimizer.coef_list], axis=0)
    return [int(k) for k in np.flatnonzero(kept > INCLUDED)]


WAYS: dict[str, Callable[[Problem], list[int]]] = {
    "threshold": threshold,
    "prune": prune,
    "greedy": greedy,
    "ensemble": ensemble,
}


def choose(regression: Regression, how: str) -> dict[str, Chosen]:
    """Return what one of the `WAYS` chooses, by effect."""
    table = np.column_stack([column for column, _ in regression.columns.values()])
    norms = np.linalg.norm(table, axis=0)
    alive = norms > 0
    names = [name for name, ok in zip(regression.columns, alive) if ok]
    scale = norms[alive]
    problem = Problem(table[:, alive] / scale, regression.rest)
    chosen = WAYS[how](problem)
    if not chosen:
        return {}
    columns = problem.table[:, chosen]
    fit = np.linalg.lstsq(columns, problem.rest, rcond=1e-8)[0]
    noise = np.sqrt(np.mean((problem.rest - columns @ fit) ** 2))
    spread = noise * np.sqrt(np.diag(np.linalg.pinv(columns.T @ columns)))
    full = problem.held_out_error(chosen)
    gained = {k: 1 - full / max(problem.held_out_error([c for c in chosen if c != k]), 1e-30) for k in chosen}
    return {names[k]: Chosen(v / scale[k], e / scale[k], gained[k]) for k, v, e in zip(chosen, fit, spread)}
