"""Proposals of several effects at once: the signatures of all candidates weighed together, in closed form.

Effects that hide each other pass no gate one at a time: while two are missing, the errors that each leaves look like noise of the other.
With r the residual of a fitted model, J its Jacobian and s_g the signatures of candidates,

    r(d, a) = r + J d + sum_g a_g s_g,    a_g ~ N(0, 1)

whitened by an ARMA(1,1) process that stands for noise and discrepancy (`estimation.noise_model`), d without information but its priors.
The evidence of any subset of the a_g then needs one Cholesky factor. Subsets are searched from none upwards and from all downwards, by
additions, removals and exchanges. What is proposed is fitted and judged like any other model; `linear_evidence` says how that differs from
the evidence of a linear family, which is the answer itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrs

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.noise_model import noise_model
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy.budgets import ADAPTED
from exo_sim.diagnosis.policy.priors import SIGN_SLACK, WRONG_SIGN
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel
from exo_sim.diagnosis.selection.linear_evidence import factored
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


@dataclass(frozen=True)
class Proposal:
    """Candidates that are proposed together, beside those of the model that they were asked about, and where to begin."""

    candidates: tuple[Candidate, ...]
    values: dict[FreeParameter, float]
    gain: float


def joint_proposals(
    model: LeastSquaresModel, now: FittedModel, candidates: Sequence[Candidate], threads: Threads = SERIAL, is_spent: IsSpent = never,
    sizes: Sizes | None = None,
) -> list[Proposal]:  # fmt: skip
    """Return sets of candidates that together make a fitted model more probable, best first; none where no set does.

    Faults of sensors are not among them: between them, delays and scales imitate whatever a valve does.

    Args:
        model: The subsystem.
        now: A fitted model.
        candidates: All candidates; those whose effect is in the model already are left out.
        threads: Threads for the predictions.
        is_spent: Whether the time is up: then nothing is proposed.
        sizes: At which signatures stood out of the noise before; what is found here is added.
    """
    directions = _directions(model, now, candidates, threads, is_spent, {} if sizes is None else sizes)
    if not directions or is_spent():
        return []
    weighing = _Weighing(model, now, directions)
    found: dict[frozenset[tuple[str, str, str]], Proposal] = {}
    for begun in ((), weighing.one_of_each()):
        chosen = weighing.best_from(begun)
        if chosen:
            proposal = weighing.proposal(chosen)
            found.setdefault(frozenset(c.key for c in proposal.candidates), proposal)
    return sorted((p for p in found.values() if p.gain > 0.0), key=lambda p: -p.gain)


def _directions(
    model: LeastSquaresModel, now: FittedModel, candidates: Sequence[Candidate], threads: Threads, is_spent: IsSpent, known: Sizes
) -> list[Direction]:
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


#: Indices of directions, one for each effect and place at most.
Chosen = tuple[int, ...]


class _Weighing:
    """Evidence of subsets of directions beside a fitted model."""

    def __init__(self, model: LeastSquaresModel, now: FittedModel, directions: Sequence[Direction]):
        self.directions = directions
        self._blocks, self._base = model.blocks, now.fit.residual
        prior_rows, prior_jac = prior_terms(now.fit.parameters, now.fit.values)
        values = now.fit.values
        loose = [j for j, q in enumerate(now.fit.parameters) if q.low < values[q] < q.high]
        self._free, self._prior = now.fit.jacobian[:, loose], (prior_rows, prior_jac[:, loose])
        width = [one.columns.shape[1] for one in directions]
        edges = np.concatenate([[0], np.cumsum(width)])
        self._of = [np.arange(a, b) for a, b in zip(edges[:-1], edges[1:], strict=True)]
        self._raw = np.hstack([one.columns for one in directions])
        self._log_prior = [one.candidate.prior_log_odds for one in directions]
        self._standing = now.bears
        self._whiten(self._base)

    def _has_orphan(self, chosen: Chosen) -> bool:
        """Return whether what a direction comes on top of is neither in the model nor chosen."""
        there = self._standing.union(*(self.directions[i].candidate.bears for i in chosen))
        return any(self.directions[i].candidate.prerequisite not in ("", *there) for i in chosen)

    def _whiten(self, residual: Array) -> None:
        """Estimate the error process from a residual, and project every whitened signature clear of what is free already."""
        process = noise_model(residual, self._blocks)
        rows, jac = self._prior
        free = np.vstack([process.whitened(self._free), jac])
        target = np.concatenate([process.whitened(self._base), rows])
        columns = np.vstack([process.whitened(self._raw), np.zeros((len(rows), self._raw.shape[1]))])
        if free.shape[1]:
            basis = np.linalg.qr(free)[0]
            target = target - basis @ (basis.T @ target)
            columns = columns - basis @ (basis.T @ columns)
        self._normal, self._pull = columns.T @ columns, -(columns.T @ target)

    def evidence(self, chosen: Chosen) -> tuple[float, Array]:
        """Return the log of a subset's evidence over the empty one's, with the prior odds, and the amplitudes."""
        if not chosen:
            return 0.0, np.zeros(0)
        if self._has_orphan(chosen):
            return -math.inf, np.zeros(0)
        at = np.concatenate([self._of[i] for i in chosen])
        normal = self._normal[np.ix_(at, at)] + np.eye(len(at))
        factor = factored(normal)
        amplitudes = dpotrs(factor, self._pull[at], lower=1)[0]
        value = 0.5 * float(self._pull[at] @ amplitudes) - float(np.sum(np.log(np.diag(factor))))
        spreads = np.sqrt(np.diag(dpotrs(factor, np.eye(len(at)), lower=1)[0]))
        position = 0
        for i in chosen:
            value += self._log_prior[i]
            count = len(self._of[i])
            if self.directions[i].one_sided:
                out = -amplitudes[position : position + count] / spreads[position : position + count]
                value -= float(np.sum(np.where(out > SIGN_SLACK, 0.5 * out * out + WRONG_SIGN / count, 0.0)))
            position += count
        return value, amplitudes

    def one_of_each(self) -> Chosen:
        """Return for each effect and place the direction that alone is most probable."""
        best: dict[tuple[str, str], tuple[float, int]] = {}
        for i, one in enumerate(self.directions):
            value = self.evidence((i,))[0]
            if value == -math.inf:
                continue
            if one.candidate.at not in best or value > best[one.candidate.at][0]:
                best[one.candidate.at] = value, i
        return tuple(sorted(i for _, i in best.values()))

    def best_from(self, chosen: Chosen) -> Chosen:
        """Return the subset that no addition, removal or exchange betters, reached from another; the error process is estimated anew."""
        self._whiten(self._base)
        for _ in range(ADAPTED):
            value = self.evidence(chosen)[0]
            while True:
                better = max(((self.evidence(one)[0], one) for one in self._neighbours(chosen)), default=(-math.inf, ()))
                if better[0] <= value + 1e-9:
                    break
                value, chosen = better
            self._whiten(self._left(chosen))
        return chosen

    def _neighbours(self, chosen: Chosen) -> Iterator[Chosen]:
        taken = {self.directions[i].candidate.at: i for i in chosen}
        for i in chosen:
            yield tuple(j for j in chosen if j != i)
        for i, one in enumerate(self.directions):
            if i in chosen:
                continue
            rival = taken.get(one.candidate.at)
            if rival is not None:
                yield tuple(sorted((*(j for j in chosen if j != rival), i)))
                continue
            yield tuple(sorted((*chosen, i)))
            for j in chosen:
                yield tuple(sorted((*(other for other in chosen if other != j), i)))

    def _left(self, chosen: Chosen) -> Array:
        """Return the residual that a subset leaves, its amplitudes and whatever is free refitted."""
        if not chosen:
            return self._base
        columns = np.hstack([self._free, *(self._raw[:, self._of[i]] for i in chosen)])
        return self._base - columns @ np.linalg.lstsq(columns, self._base, rcond=None)[0]

    def proposal(self, chosen: Chosen) -> Proposal:
        """Return a subset as candidates with values to begin with."""
        gain, amplitudes = self.evidence(chosen)
        values: dict[FreeParameter, float] = {}
        position = 0
        for i in chosen:
            count = len(self._of[i])
            values |= self.directions[i].values(amplitudes[position : position + count])
            position += count
        return Proposal(tuple(self.directions[i].candidate for i in chosen), values, gain)
