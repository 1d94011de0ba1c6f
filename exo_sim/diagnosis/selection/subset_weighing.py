"""The subsets of a linear family, weighed against each other: which effects are present, none of which has to be found first.

Which terms are present is climbed to from both ends, from none and from all of them, by changing one or two at a time. The subsets that
come near the best are weighed once more with the noise and the discrepancy estimated for each of them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Term
from exo_sim.diagnosis.policy.budgets import FAMILY_FINALISTS, MOST_CLIMBS
from exo_sim.diagnosis.policy.priors import FAMILY_SIZE
from exo_sim.diagnosis.selection.linear_evidence import LinearEvidence, Posterior, Spreads, Subset

At = tuple[str, str]


@dataclass(frozen=True)
class Weighed:
    """A subset, and what it weighs.

    Attributes:
        point: Linearisation point of the family: which of its linearisations.
        subset: The terms of it.
        score: Logarithm of the probability, up to a constant.
        spreads: At which it was weighed.
    """

    point: int
    subset: Subset
    score: float
    spreads: Spreads


class SubsetWeighing:
    """The weighing of the subsets of one family.

    Args:
        family: The family.
        basis: Of its discrepancy.
        blocks: Block of time of each row.
        standing: Effects that the nominal machine has anyhow.
        is_spent: Whether the time is up: then the best that was met is climbed no further.

    Attributes:
        correlation_time: Of what everything together leaves, in rows; 1 until it was weighed.
    """

    def __init__(
        self, family: LinearFamily, basis: DiscrepancyBasis, blocks: NDArray[np.int64], standing: Sequence[str] = (),
        is_spent: IsSpent = never,
    ):  # fmt: skip
        self._is_spent = is_spent
        self.family, self.standing = family, frozenset(standing)
        self._evidence = [LinearEvidence(linear, basis) for linear in family.linearisations]
        self._basis, self._blocks = basis, blocks
        self._groups_of = [_groups_of_effects(linear.terms) for linear in family.linearisations]
        self.correlation_time = 1.0

    def posterior(self, weighed: Weighed, more: Subset = ()) -> Posterior:
        """Return the posterior of a subset, with more terms in it where they are given, and what it leaves."""
        subset = tuple(sorted((*weighed.subset, *more)))
        return self._evidence[weighed.point].posterior(subset, weighed.spreads, self.correlation_time, whole=True)

    def square_left(self, posterior: Posterior) -> float:
        """Return the squared error that a subset leaves, its discrepancy among it."""
        left = posterior.left + self._basis.columns @ posterior.discrepancy
        return float(left @ left)

    def terms(self, weighed: Weighed) -> list[Term]:
        """Return the terms of a subset."""
        return [self.family.linearisations[weighed.point].terms[j] for j in weighed.subset]

    def candidates(self, weighed: Weighed) -> tuple[Candidate, ...]:
        """Return the effects of a subset, each once."""
        effect = self.family.linearisations[weighed.point].candidate
        found = [term.candidate for term in self.terms(weighed)] + ([effect] if effect is not None else [])
        return tuple({candidate.at: candidate for candidate in found}.values())

    def probabilities(self, finalists: Sequence[Weighed]) -> dict[At, float]:
        """Return the probability of each effect being present, over the subsets that were weighed to the end."""
        every = {candidate.at for one in finalists for candidate in self.candidates(one)}
        return {at: self.probability_of_any(finalists, {at}) for at in sorted(every)}

    def probability_of_any(self, finalists: Sequence[Weighed], effects: Collection[At]) -> float:
        """Return the probability that any of these effects is present, over the subsets that were weighed to the end."""
        scores = np.array([one.score for one in finalists])
        weights = np.exp(scores - scores.max())
        present = [any(candidate.at in effects for candidate in self.candidates(one)) for one in finalists]
        return float(weights[present].sum() / weights.sum())

    def finalists(self) -> list[Weighed]:
        """Return the most probable subsets, best first."""
        everything, spreads, _ = self._beside_everything()
        found: dict[tuple[int, Subset], Weighed] = {}
        for start in ((), everything):
            self._weigh_around(0, start, spreads, found)
        best = max(found.values(), key=lambda one: one.score)
        for _ in range(MOST_CLIMBS):
            if self._is_spent():
                break
            self._weigh_around(best.point, best.subset, best.spreads, found)
            best = max(found.values(), key=lambda one: one.score)
            for at in [candidate.at for candidate in self.candidates(best)]:
                self._weigh_without(at, best, found)
            better = max(found.values(), key=lambda one: one.score)
            if better is best:
                break
            best = better
        return sorted(found.values(), key=lambda one: -one.score)

    def left_by_everything(self) -> NDArray[np.float64]:
        """Return what one term of every group and the discrepancy leave of the target together, shape (n,)."""
        return self._beside_everything()[2]

    def _beside_everything(self) -> tuple[Subset, Spreads, NDArray[np.float64]]:
        """Return one term of every group, the spreads estimated beside them all, and what they leave; sets the correlation time."""
        target = self.family.linearisations[0].target
        centred = target - target.mean()
        amplitudes = tuple(0.5 * float(scale) for scale in self._basis.healthy)
        spreads = Spreads(max(FAMILY_SIZE * float(np.sqrt(np.mean(centred**2))), 1.0), amplitudes)
        everything, plain, left = self._everything(), self._evidence[0], target
        for _ in range(2):
            _, spreads = plain.estimated(everything, spreads, self.correlation_time, sweeps=3)
            left = plain.posterior(everything, spreads, self.correlation_time, whole=True).left
            self.correlation_time = correlation_time(left, self._blocks)
        return everything, spreads, left

    def _weigh_around(self, point: int, start: Subset, spreads: Spreads, found: dict[tuple[int, Subset], Weighed]) -> None:
        """Weigh the best subsets that a climb meets, at this linearisation point and from its top at the others."""
        weighed: dict[tuple[int, Subset], float] = {}
        top = self._climbed(point, start, spreads, weighed, pairs=True)
        for other in range(len(self.family.linearisations)):
            if other != point and not self._is_spent():
                self._climbed(other, top, spreads, weighed, pairs=False)
        for key in sorted(weighed, key=lambda key: -weighed[key])[:FAMILY_FINALISTS]:
            self._weigh(key, spreads, found)

    def alike(self, best: Weighed, finalists: Sequence[Weighed]) -> list[Weighed]:
        """Return a subset and those that hold its effects in another law, beside those that were weighed to the end.

        All at the spreads of the best, at every linearisation point: which law it is need not be known for the effects to be.
        """
        wanted = [term.candidate.at for term in self.terms(best)]
        found = {(one.point, one.subset): one for one in finalists if set(wanted) <= {term.candidate.at for term in self.terms(one)}}
        for point, one in enumerate(self.family.linearisations):
            laws = [[j for j, term in enumerate(one.terms) if term.candidate.at == at] for at in wanted]
            for chosen in itertools.product(*laws):
                key = point, tuple(sorted(set(chosen)))
                if key in found or len(key[1]) != len(wanted):
                    continue
                evidence = self._evidence[point].log_evidence(key[1], best.spreads, self.correlation_time)
                found[key] = Weighed(*key, evidence + self._log_prior(*key), best.spreads)
        return [one for one in found.values() if one.score > -math.inf]

    def _weigh_without(self, at: At, best: Weighed, found: dict[tuple[int, Subset], Weighed]) -> None:
        """Weigh the best subset that lacks an effect of the best one."""
        effect = self.family.linearisations[best.point].candidate
        point = 0 if effect is not None and effect.at == at else best.point
        start = tuple(j for j in best.subset if self._at(best.point, j) != at)
        key = point, self._climbed(point, start, best.spreads, {}, pairs=False, lacking=at)
        self._weigh(key, best.spreads, found)

    def _weigh(self, key: tuple[int, Subset], spreads: Spreads, found: dict[tuple[int, Subset], Weighed]) -> None:
        """Weigh a subset with spreads of its own, estimated from these; what it had before stays where it is better."""
        evidence, own = self._evidence[key[0]].estimated(key[1], spreads, self.correlation_time)
        score = evidence + self._log_prior(*key)
        if key not in found or score > found[key].score:
            found[key] = Weighed(*key, score, own)

    def _everything(self) -> Subset:
        """Return one term of every group: the one that lowers the target's square most beside the background."""
        plain = self._evidence[0]
        spreads = Spreads(1.0, tuple(float(scale) for scale in self._basis.healthy))
        chosen: list[int] = []
        for members in self._groups(0).values():
            chosen.append(max(members, key=lambda j: plain.log_evidence((j,), spreads, 1.0)))
        return tuple(sorted(chosen))

    def _climbed(
        self, point: int, start: Subset, spreads: Spreads, weighed: dict[tuple[int, Subset], float], pairs: bool, lacking: At | None = None
    ) -> Subset:
        """Climb to a subset that no change of one group, or of two with `pairs`, makes more probable; none has the effect `lacking`."""

        def score(subset: Subset) -> float:
            key = point, subset
            if key not in weighed:
                prior = self._log_prior(point, subset)
                found = self._evidence[point].log_evidence(subset, spreads, self.correlation_time) if prior > -math.inf else 0.0
                weighed[key] = found + prior
            return weighed[key]

        now = start
        score(now)
        while True:
            best = max(self._changed(point, now, pairs, lacking), key=score, default=now)
            if score(best) <= score(now) + 1e-9:
                return now
            now = best

    def _changed(self, point: int, subset: Subset, pairs: bool, lacking: At | None) -> Iterator[Subset]:
        """Return every subset in which one group, or two of them, have another term or none."""
        groups = self._groups(point)
        options: dict[str, list[tuple[int, ...]]] = {
            name: [(), *((j,) for j in members if self._at(point, j) != lacking)] for name, members in groups.items()
        }
        for name, choices in options.items():
            rest = tuple(j for j in subset if j not in groups[name])
            for choice in choices:
                yield tuple(sorted((*rest, *choice)))
        if pairs:
            for (one, first), (other, second) in itertools.combinations(options.items(), 2):
                rest = tuple(j for j in subset if j not in groups[one] and j not in groups[other])
                for choice, more in itertools.product(first, second):
                    yield tuple(sorted((*rest, *choice, *more)))

    def _groups(self, point: int) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for j, term in enumerate(self.family.linearisations[point].terms):
            found.setdefault(term.group, []).append(j)
        return found

    def _log_prior(self, point: int, subset: Subset) -> float:
        """Return the logarithm of the prior odds of a subset; minus infinity where an effect lacks what it comes on top of."""
        chosen = self.family.linearisations[point]
        terms = [chosen.terms[j] for j in subset]
        groups = {term.group for term in terms}
        total = sum(term.log_prior for term in terms)
        asked = [(term.candidate, term.alternatives) for term in terms]
        if chosen.candidate is not None:
            asked.append((chosen.candidate, chosen.alternatives))
        for candidate, alternatives in asked:
            base = candidate.prerequisite
            if base and base not in self.standing and groups.isdisjoint(self._groups_of[point].get(base, ())):
                return -math.inf
            total += candidate.prevalence_log_odds - math.log(alternatives)
        return total

    def _at(self, point: int, term: int) -> At:
        return self.family.linearisations[point].terms[term].candidate.at


def _groups_of_effects(terms: Sequence[Term]) -> dict[str, set[str]]:
    """Return the groups in which each effect has a term, by its name: asked of every subset, of thousands."""
    found: dict[str, set[str]] = {}
    for term in terms:
        found.setdefault(term.candidate.effect, set()).add(term.group)
    return found
