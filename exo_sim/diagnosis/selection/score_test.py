"""The score test: each candidate's signature, projected clear of the fitted parameters, against what is left of the error."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.policy import signatures
from exo_sim.diagnosis.selection.cleared import Cleared
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel

Array = NDArray[np.float64]


#: At which share of a candidate's start its signature stood out of the noise when it was asked last, by candidate and start.
Sizes = dict[tuple[CandidateKey, tuple[float, ...]], float]
#: Where a candidate in proportion leaves least along its signature, all else refitted along its derivatives, by candidate.
Promised = dict[CandidateKey, tuple[float, ...]]


def in_proportion(values: Mapping[FreeParameter, float], size: float) -> dict[FreeParameter, float]:
    """Return so large a share of what values differ from neutral ones, within the bounds of each."""
    return {q: float(np.clip(q.neutral + size * (v - q.neutral), q.low, q.high)) for q, v in values.items()}


class Signatures:
    """Signatures of candidates beside one fitted model, each predicted once.

    Args:
        model: The subsystem.
        beside: The fitted model.
        sizes, promised: Known from other fitted models of the subsystem; what is found here is added.
    """

    def __init__(self, model: LeastSquaresModel, beside: FittedModel, sizes: Sizes | None = None, promised: Promised | None = None):
        self._model, self._beside = model, beside
        self._sizes: Sizes = {} if sizes is None else sizes
        self._promised: Promised = {} if promised is None else promised
        self._kept: dict[CandidateKey, list[tuple[Array, dict[FreeParameter, float]]]] = {}

    def promise(self, candidate: Candidate, values: dict[FreeParameter, float], share: float) -> None:
        """Keep where a candidate leaves least: at so large a share of the size that its signature has."""
        if candidate.proportional:
            self._promised[candidate.key] = tuple(in_proportion(values, share).values())

    def of(self, candidate: Candidate) -> list[tuple[Array, dict[FreeParameter, float]]]:
        """Return the changes of the residual by a candidate, shape (n,) each, and the size: one for each start that can be predicted."""
        if candidate.key not in self._kept:
            base = self._beside.fit.residual
            level = math.sqrt(float(base @ base) / max(base.size, 1))
            found = [
                signature(self._model, candidate, start, self._beside, self._beside.fixed, base, level, self._sizes)
                for start in candidate.starts
            ]
            self._kept[candidate.key] = [pair for pair in found if pair is not None]
        return self._kept[candidate.key]


def scores(
    model: LeastSquaresModel, now: FittedModel, candidates: Sequence[Candidate], threads: Threads = SERIAL,
    signatures: Signatures | None = None, is_spent: IsSpent = never,
) -> list[tuple[float, Candidate]]:  # fmt: skip
    """Return the candidates that are not in a fitted model with the drop in squared error that their signature promises, best first.

    Args:
        model: The subsystem.
        now: The fitted model.
        candidates: What is scored.
        threads: Threads for the predictions.
        signatures: Of a neighbouring model; of this one when absent.
        is_spent: Whether the time is up: what was not looked at then promises nothing.
    """
    signatures = signatures or Signatures(model, now)
    base = now.fit.residual
    fixed_now = now.fixed
    cleared: dict[frozenset[tuple[str, str]], Cleared] = {}
    held = {q.slot for q in now.fit.parameters}

    def clear_of(candidate: Candidate) -> Cleared:
        """Return what the fitted parameters leave, those left out that the candidate stands for."""
        slots = frozenset(q.slot for q in candidate.parameters) & held
        if slots not in cleared:
            cleared[slots] = Cleared.of(now.fit, slots)
        return cleared[slots]

    level = math.sqrt(float(base @ base) / max(base.size, 1))

    def score(candidate: Candidate) -> tuple[float, Candidate]:
        best = 0.0
        if is_spent():
            return best, candidate
        beyond = clear_of(candidate)
        if candidate.is_law:
            return _promise_of_law(model, candidate, now, fixed_now, level, beyond), candidate
        for change, values in signatures.of(candidate):
            clear = beyond.clear(change)
            power = float(clear @ clear)
            pull = -float(clear @ beyond.left)
            if power <= 1e-12 * float(change @ change) or power == 0.0:
                continue
            one_sided = all(q.low >= q.neutral and q.slot not in held for q in candidate.parameters)
            if pull <= 0.0 and one_sided:
                continue
            if pull * pull / power > best:
                best = pull * pull / power
                signatures.promise(candidate, values, pull / power)
        return best, candidate

    left = [c for c in candidates if c.at not in now.named and now.meets_prerequisite(c)]
    scored = threads.predictions(score, left)
    return sorted(scored, key=lambda pair: -pair[0])


def law_signatures(
    model: LeastSquaresModel, candidate: Candidate, now: FittedModel, fixed_now: Sequence[tuple[FreeParameter, float]]
) -> Array:
    """Return the change of the residual by one standard deviation of each parameter of a law, shape (n, p)."""
    columns = []
    for q in candidate.parameters:
        there = {p: p.start + (spread_of(q) if p is q else 0.0) for p in candidate.parameters}
        columns.append(model.residual({**now.fit.values, **there}, [*fixed_now, *candidate.fixed]) - now.fit.residual)
    return np.column_stack(columns)


def spread_of(parameter: FreeParameter) -> float:
    """Return what is known of a parameter before any data: a standard deviation, or its scale."""
    return parameter.prior[1] if parameter.prior else parameter.scale


def _promise_of_law(
    model: LeastSquaresModel, candidate: Candidate, now: FittedModel, fixed_now: list[tuple[FreeParameter, float]], level: float,
    beyond: Cleared,
) -> float:  # fmt: skip
    """Return the drop in squared error that a law promises whose parameters may all move at once, as far as is known of them."""
    columns = law_signatures(model, candidate, now, fixed_now)
    if not np.isfinite(columns).all():
        return 0.0
    clear = np.column_stack([beyond.clear(column) for column in columns.T])
    normal = clear.T @ clear + max(level, 1.0) ** 2 * np.eye(clear.shape[1])
    pull = clear.T @ beyond.left
    return float(pull @ np.linalg.solve(normal, pull))


def signature(
    model: LeastSquaresModel,
    candidate: Candidate,
    start: tuple[float, ...],
    now: FittedModel,
    fixed_now: Sequence[tuple[FreeParameter, float]],
    base: Array,
    level: float,
    sizes: Sizes,
) -> tuple[Array, dict[FreeParameter, float]] | None:
    """Return the change of the residual when a candidate is put in at a size that stands out of the noise but does not swamp it.

    With the change comes the size; None where the prediction is not finite.

    Args:
        model: The subsystem.
        candidate: What is put in ...
        start: ... at this size, or in proportion.
        now: The fitted model that it is put into.
        fixed_now: What that holds at a value.
        base: Its residual, shape (n,).
        level: Root mean square of that.
        sizes: Where to begin; the size that is found is entered.
    """
    size = sizes.get((candidate.key, start), 1.0)
    for _ in range(signatures.MOST_SIZES if candidate.proportional else 1):
        values = in_proportion(dict(zip(candidate.parameters, start, strict=True)), size)
        change = model.residual({**now.fit.values, **values}, [*fixed_now, *candidate.fixed]) - base
        if not np.isfinite(change).all():
            return None
        strength = math.sqrt(float(change @ change) / change.size)
        if strength > signatures.SWAMPS * level and size > signatures.SMALLEST:
            size *= signatures.SMALLER
        elif strength < signatures.DROWNS * level and size < signatures.LARGEST:
            size *= signatures.LARGER
        else:
            break
    sizes[candidate.key, start] = size
    return change, values
