"""Proposals of several effects at once: the signatures of all candidates weighed together, in closed form.

Effects that hide each other pass no gate one at a time: while two are missing, the errors that each leaves look like noise of the other.
With r the residual of a fitted model, J its Jacobian and s_g the signatures of candidates,

    r(d, a) = r + J d + sum_g a_g s_g,    a_g ~ N(0, 1)

whitened by an ARMA(1,1) process that stands for noise and discrepancy (`estimation.noise_model`), d without information but its priors.
The evidence of any subset of the a_g is then known in closed form. Subsets are searched from none upwards and from all downwards, by
additions, removals and exchanges. What is proposed is fitted and judged like any other model; `linear_evidence` says how that differs from
the evidence of a linear family, which is the answer itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.noise_model import noise_model
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.policy.budgets import ADAPTED
from exo_sim.diagnosis.policy.priors import SIGN_SLACK, WRONG_SIGN
from exo_sim.diagnosis.selection.directions import Direction, directions
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel
from exo_sim.diagnosis.selection.score_test import Sizes

Array = NDArray[np.float64]


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
    asked = directions(model, now, candidates, threads, is_spent, {} if sizes is None else sizes)
    if not asked or is_spent():
        return []
    weighing = _Weighing(model, now, asked)
    found: dict[frozenset[tuple[str, str, str]], Proposal] = {}
    for begun in ((), weighing.one_of_each()):
        chosen = weighing.best_from(begun)
        if chosen:
            proposal = weighing.proposal(chosen)
            found.setdefault(frozenset(c.key for c in proposal.candidates), proposal)
    return sorted((p for p in found.values() if p.gain > 0.0), key=lambda p: -p.gain)


#: Indices of directions, one for each effect and place at most.
Chosen = tuple[int, ...]


class _Weighing:
    """Evidence of subsets of directions beside a fitted model."""

    def __init__(self, model: LeastSquaresModel, now: FittedModel, asked: Sequence[Direction]):
        self.directions = asked
        self._blocks, self._base = model.blocks, now.fit.residual
        prior_rows, prior_jac = prior_terms(now.fit.parameters, now.fit.values)
        values = now.fit.values
        loose = [j for j, q in enumerate(now.fit.parameters) if q.low < values[q] < q.high]
        self._free, self._prior = now.fit.jacobian[:, loose], (prior_rows, prior_jac[:, loose])
        widths = [one.columns.shape[1] for one in asked]
        edges = np.concatenate([[0], np.cumsum(widths)])
        self._of = [tuple(range(a, b)) for a, b in zip(edges[:-1], edges[1:], strict=True)]
        self._raw = np.hstack([one.columns for one in asked])
        self._log_prior = [one.candidate.prior_log_odds for one in asked]
        self._one_sided = np.repeat([one.one_sided for one in asked], widths)
        self._wrong_sign = np.repeat(WRONG_SIGN / np.array(widths), widths)
        there = now.bears
        self._needs = {i: one.candidate.prerequisite for i, one in enumerate(asked) if one.candidate.prerequisite not in ("", *there)}
        self._whiten(self._base)

    def _has_orphan(self, chosen: Chosen) -> bool:
        """Return whether what a direction comes on top of is neither in the model nor chosen."""
        needed = {self._needs[i] for i in chosen if i in self._needs}
        return bool(needed) and not needed <= set().union(*(self.directions[i].candidate.bears for i in chosen))

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
        self._precision, self._pull = columns.T @ columns + np.eye(columns.shape[1]), -(columns.T @ target)
        if not np.isfinite(self._precision).all():
            raise np.linalg.LinAlgError("the signatures of what may be proposed together are not finite")

    def _columns(self, chosen: Chosen) -> list[int]:
        return [column for i in chosen for column in self._of[i]]

    def amplitudes(self, chosen: Chosen) -> Array:
        """Return the posterior mean of the amplitudes of a subset, one for each of its columns."""
        at = self._columns(chosen)
        return np.linalg.solve(self._precision[np.ix_(at, at)], self._pull[at])

    def evidence(self, subsets: Sequence[Chosen]) -> list[float]:
        """Return the log of the evidence of each subset over the empty one's, with the prior odds.

        Those of as many columns are weighed at once: there are tens of thousands, and alone most of each is the call.
        """
        found = [-math.inf] * len(subsets)
        alike: dict[int, list[int]] = {}
        columns = [self._columns(chosen) for chosen in subsets]
        for place, chosen in enumerate(subsets):
            if not self._has_orphan(chosen):
                alike.setdefault(len(columns[place]), []).append(place)
        for places in alike.values():
            weighed = self._weighed(np.array([columns[place] for place in places], dtype=int))
            for place, value in zip(places, weighed, strict=True):
                found[place] = float(value) + sum(self._log_prior[i] for i in subsets[place])
        return found

    def _weighed(self, at: NDArray[np.int_]) -> Array:
        """Return the log of the evidence of subsets given by their columns, shape (g, m), without the prior odds, shape (g,)."""
        precision, pull = self._precision[at[:, :, None], at[:, None, :]], self._pull[at]
        amplitudes = np.linalg.solve(precision, pull[:, :, None])[:, :, 0]
        half_log_determinant = np.log(np.einsum("gii->gi", np.linalg.cholesky(precision))).sum(axis=1)
        out = -amplitudes / np.sqrt(np.einsum("gii->gi", np.linalg.inv(precision)))
        wrong = np.where(self._one_sided[at] & (out > SIGN_SLACK), 0.5 * out * out + self._wrong_sign[at], 0.0)
        return np.asarray(0.5 * np.sum(pull * amplitudes, axis=1) - half_log_determinant - np.sum(wrong, axis=1))

    def one_of_each(self) -> Chosen:
        """Return for each effect and place the direction that alone is most probable."""
        best: dict[tuple[str, str], tuple[float, int]] = {}
        for i, value in enumerate(self.evidence([(i,) for i in range(len(self.directions))])):
            at = self.directions[i].candidate.at
            if value > best.get(at, (-math.inf, i))[0]:
                best[at] = value, i
        return tuple(sorted(i for _, i in best.values()))

    def best_from(self, chosen: Chosen) -> Chosen:
        """Return the subset that no addition, removal or exchange betters, reached from another; the error process is estimated anew."""
        self._whiten(self._base)
        for _ in range(ADAPTED):
            value = self.evidence([chosen])[0]
            while True:
                neighbours = list(self._neighbours(chosen))
                better = max(zip(self.evidence(neighbours), neighbours, strict=True), default=(-math.inf, ()))
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
        columns = np.hstack([self._free, self._raw[:, self._columns(chosen)]])
        return self._base - columns @ np.linalg.lstsq(columns, self._base, rcond=None)[0]

    def proposal(self, chosen: Chosen) -> Proposal:
        """Return a subset as candidates with values to begin with."""
        gain, amplitudes = self.evidence([chosen])[0], self.amplitudes(chosen)
        values: dict[FreeParameter, float] = {}
        position = 0
        for i in chosen:
            count = len(self._of[i])
            values |= self.directions[i].values(amplitudes[position : position + count])
            position += count
        return Proposal(tuple(self.directions[i].candidate for i in chosen), values, gain)
