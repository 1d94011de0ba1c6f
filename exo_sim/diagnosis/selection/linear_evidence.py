"""Evidence for every subset of a linear family, in closed form.

With y the target, N the background, T the columns of the terms that are present and D those of the discrepancy,

    y = N u + T a + D w + e,   u ~ N(0, I),   a_j ~ N(0, s_j^2),   w_j ~ N(0, h_k(j)^2),   e ~ N(0, tau sigma^2 I),

tau the correlation time of the residual in rows, which keeps slow errors from counting as often as there are rows. The evidence of a
subset needs one Cholesky factor. The amplitudes h have half-normal priors about what a healthy machine shows; they and sigma are
estimated by maximising the evidence (empirical Bayes). A size of one sign has a half-normal prior, and no evidence on the other side.

`joint_proposal` weighs subsets by the same kind of evidence for another end: there terms are signatures about one fit, rows are whitened by
a process taken from its residual, and what comes out is only where the next fit begins. Here the target is the data themselves, noise and
discrepancy are estimated with each subset, and the evidence is what the answer rests on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve
from scipy.linalg.lapack import dpotrf, dtrtrs

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.linear_family import Linearisation
from exo_sim.diagnosis.policy.priors import LEAST_AMPLITUDE, LEAST_NOISE, MOST_AMPLITUDE

Array = NDArray[np.float64]
#: Indices of the terms that are present.
Subset = tuple[int, ...]

#: Factors by which standard deviations are varied when they are estimated.
_FACTORS = (0.3, 0.6, 0.85, 1.2, 1.7, 3.0)


@dataclass(frozen=True)
class Spreads:
    """What is estimated by maximising the evidence: the noise of a row, and the amplitude of each kind of discrepancy."""

    noise: float
    amplitudes: tuple[float, ...]


@dataclass(frozen=True)
class Posterior:
    """The posterior of one subset.

    Attributes:
        log_evidence: Natural logarithm of the evidence; minus infinity where a size has a sign that it cannot have.
        background: Posterior mean of the nuisance parameters, in prior standard deviations, shape (p,).
        sizes: Posterior mean of the sizes of its terms, shape (m,).
        errors: Their posterior standard deviations, shape (m,).
        discrepancy: Posterior mean of the discrepancy's weights, shape (d,).
        left: Target less everything, shape (n,); only where it was asked for.
    """

    log_evidence: float
    background: Array
    sizes: Array
    errors: Array
    discrepancy: Array
    left: Array


def _factored(precision: Array) -> Array:
    """Return the lower Cholesky factor of a posterior precision in units of the prior, shape (m, m).

    LAPACK is called as it is: of tens of thousands of subsets SciPy's checks take longer than the factors.

    Raises:
        LinAlgError: the precision is not finite.
    """
    factor, failed = dpotrf(precision, lower=1, clean=1)
    if failed:
        raise LinAlgError("the evidence of a subset is not finite")
    return np.asarray(factor)


@dataclass(frozen=True)
class _Cleared:
    """All terms in units of their spreads, projected clear of background and discrepancy, for one set of spreads.

    Attributes:
        normal: Their normal equations, shape (t, t).
        pull: Right-hand side, shape (t,).
        log_evidence: Of no term.
    """

    normal: Array
    pull: Array
    log_evidence: float


@dataclass(frozen=True)
class _Part:
    """What a subset takes of the normal equations, the same at all spreads.

    Attributes:
        index: Its columns of the design, shape (m,), background and discrepancy first.
        gram, moment: Their normal equations, shape (m, m) and (m,).
        spread: Prior standard deviations of the sizes of its terms, shape (t,).
        one_sided: Which of these cannot be negative, shape (t,).
    """

    index: NDArray[np.int64]
    gram: Array
    moment: Array
    spread: Array
    one_sided: NDArray[np.bool_]


class LinearEvidence:
    """The evidence for the subsets of one linearisation of a family.

    Args:
        linear: The family at one value of what every term depends on.
        basis: Of the discrepancy.
    """

    def __init__(self, linear: Linearisation, basis: DiscrepancyBasis):
        self.linear, self.basis = linear, basis
        self._design = np.hstack([linear.background, basis.columns, *(term.columns for term in linear.terms)])
        self._gram, self._moment = self._design.T @ self._design, self._design.T @ linear.target
        self._square = float(linear.target @ linear.target)
        first = linear.background.shape[1] + basis.columns.shape[1]
        self._always = np.arange(first)
        self._columns = []
        for term in linear.terms:
            self._columns.append(np.arange(first, first + term.columns.shape[1]))
            first += term.columns.shape[1]
        self._signed = [sum(term.one_sided) for term in linear.terms]
        self._one_sided = np.array([one for term in linear.terms for one in term.one_sided], dtype=bool)
        self._latest: tuple[tuple[Spreads, float], _Cleared] | None = None

    def log_evidence(self, subset: Subset, spreads: Spreads, correlation_time: float) -> float:
        """Return the logarithm of a subset's evidence, as `posterior` does, at a small part of its cost.

        What is always there is taken out once for all subsets that are weighed at the same spreads.
        """
        key = spreads, correlation_time
        if self._latest is None or self._latest[0] != key:
            self._latest = key, self._cleared(spreads, correlation_time)
        cleared = self._latest[1]
        if not subset:
            return cleared.log_evidence
        first = len(self._always)
        at = np.concatenate([self._columns[j] for j in subset]) - first
        factor = _factored(cleared.normal[at[:, None], at])
        half = dtrtrs(factor, cleared.pull[at], lower=1)[0]
        if (dtrtrs(factor, half, lower=1, trans=1)[0][self._one_sided[at]] < 0.0).any():
            return -math.inf
        found = cleared.log_evidence + 0.5 * float(half @ half) - float(np.log(factor.diagonal()).sum())
        return found + math.log(2.0) * sum(self._signed[j] for j in subset)

    def _cleared(self, spreads: Spreads, correlation_time: float) -> _Cleared:
        """Return all terms clear of what is always there."""
        amplitudes = np.array(spreads.amplitudes)
        d = self.basis.columns.shape[1]
        scale = np.concatenate([
            np.ones(len(self._always) - d), amplitudes[self.basis.kinds] if d else np.zeros(0), *(t.spread for t in self.linear.terms)
        ])  # fmt: skip
        weight = 1.0 / (spreads.noise**2 * correlation_time)
        normal = self._gram * (weight * np.outer(scale, scale))
        normal[np.diag_indices_from(normal)] += 1.0
        moment = self._moment * (weight * scale)
        evidence = -self.linear.target.size / correlation_time * math.log(spreads.noise) - 0.5 * weight * self._square
        evidence -= 0.5 * float(np.sum((amplitudes / self.basis.healthy) ** 2))
        first = len(self._always)
        if first == 0:
            return _Cleared(normal, moment, evidence)
        factor = _factored(normal[:first, :first])
        half = dtrtrs(factor, moment[:first], lower=1)[0]
        evidence += 0.5 * float(half @ half) - float(np.log(factor.diagonal()).sum())
        if not self.linear.terms:
            return _Cleared(normal[first:, first:], moment[first:], evidence)
        across = dtrtrs(factor, normal[:first, first:], lower=1)[0]
        return _Cleared(normal[first:, first:] - across.T @ across, moment[first:] - across.T @ half, evidence)

    def posterior(self, subset: Subset, spreads: Spreads, correlation_time: float, whole: bool = False) -> Posterior:
        """Return the posterior of a subset; with `whole`, what is left of the target as well."""
        p, d = self.linear.background.shape[1], self.basis.columns.shape[1]
        part = self._part(subset)
        evidence, found, factor, scale = self._solved(part, spreads, correlation_time)
        errors, left = np.zeros(0), np.zeros(0)
        if whole:
            inverse = cho_solve((factor, True), np.eye(len(part.index)))
            errors = np.sqrt(np.diag(inverse))[p + d :] * scale[p + d :]
            left = self.linear.target - self._design[:, part.index] @ found
        return Posterior(evidence, found[:p], found[p + d :], errors, found[p : p + d], left)

    def _part(self, subset: Subset) -> _Part:
        index = np.concatenate([self._always, *(self._columns[j] for j in subset)]).astype(np.int64)
        terms = [self.linear.terms[j] for j in subset]
        one_sided = np.array([one for term in terms for one in term.one_sided], dtype=bool)
        spread = np.concatenate([np.zeros(0), *(term.spread for term in terms)])
        return _Part(index, self._gram[np.ix_(index, index)], self._moment[index], spread, one_sided)

    def _solved(self, part: _Part, spreads: Spreads, correlation_time: float) -> tuple[float, Array, Array, Array]:
        """Return the evidence of a part, its posterior mean, the factor of its precision in units of the prior, and these units."""
        p, d = self.linear.background.shape[1], self.basis.columns.shape[1]
        amplitudes = np.array(spreads.amplitudes)
        scale = np.concatenate([np.ones(p), amplitudes[self.basis.kinds] if d else np.zeros(0), part.spread])
        weight = 1.0 / (spreads.noise**2 * correlation_time)
        normal = part.gram * (weight * (scale[:, None] * scale))
        normal.flat[:: len(scale) + 1] += 1.0
        factor = _factored(normal)
        moment = part.moment * (weight * scale)
        half = dtrtrs(factor, moment, lower=1)[0] if scale.size else moment  # LAPACK complains of no rows
        evidence = -self.linear.target.size / correlation_time * math.log(spreads.noise) - 0.5 * weight * self._square
        evidence += 0.5 * float(half @ half) - float(np.log(factor.diagonal()).sum())
        evidence -= 0.5 * float(np.sum((amplitudes / self.basis.healthy) ** 2))
        found = (dtrtrs(factor, half, lower=1, trans=1)[0] if scale.size else half) * scale
        evidence += math.log(2.0) * int(part.one_sided.sum())
        if (found[p + d :][part.one_sided] < 0.0).any():
            evidence = -math.inf
        return evidence, found, factor, scale

    def estimated(self, subset: Subset, spreads: Spreads, correlation_time: float, sweeps: int = 2) -> tuple[float, Spreads]:
        """Return the evidence of a subset at the spreads that maximise it, and these."""
        part = self._part(subset)
        best, at = self._solved(part, spreads, correlation_time)[0], spreads
        for _ in range(sweeps):
            for which in range(1 + len(at.amplitudes)):
                for factor in _FACTORS:
                    tried = self._varied(at, which, factor)
                    evidence = self._solved(part, tried, correlation_time)[0]
                    if evidence > best:
                        best, at = evidence, tried
        return best, at

    def _varied(self, spreads: Spreads, which: int, factor: float) -> Spreads:
        if which == 0:
            return Spreads(max(spreads.noise * factor, LEAST_NOISE), spreads.amplitudes)
        amplitudes = list(spreads.amplitudes)
        healthy = float(self.basis.healthy[which - 1])
        amplitudes[which - 1] = min(max(amplitudes[which - 1] * factor, LEAST_AMPLITUDE * healthy), MOST_AMPLITUDE * healthy)
        return Spreads(spreads.noise, tuple(amplitudes))
