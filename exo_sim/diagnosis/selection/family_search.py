"""The search over a linear family: its most probable subset, fitted to the subsystem itself, with what speaks for and against each effect.

The terms of a family are linear only about where they were formed; the fit is not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey, drop_orphans
from exo_sim.diagnosis.estimation.least_squares import FEWEST_ROWS, Fit
from exo_sim.diagnosis.estimation.linear_family import LinearFamily
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy import judgement
from exo_sim.diagnosis.policy.budgets import RUNNERS_UP
from exo_sim.diagnosis.policy.judgement import NIL
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.evidence import Evidence
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult, exceeds_healthy_limit
from exo_sim.diagnosis.selection.linear_evidence import Posterior
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subset_weighing import At, SubsetWeighing, Weighed
from exo_sim.physics.declaration import declared


class FamilySearch:
    """A search over one family.

    Args:
        fits: Fits of its subsystem.
        family: The family.
        basis: Of the discrepancy.
        standing: Effects that the machine as believed has anyhow.
    """

    def __init__(self, fits: ModelFits, family: LinearFamily, basis: DiscrepancyBasis, standing: Sequence[str] = ()):
        self.fits, self.family = fits, family
        self.weighing = SubsetWeighing(family, basis, fits.model.blocks, standing)

    def run(self) -> SearchResult:
        """Weigh, fit and assess."""
        model = self.fits.model
        if model.size < FEWEST_ROWS:
            empty = FittedModel((), Fit((), {}, np.zeros(0), np.zeros((0, 0))))
            return SearchResult(empty, empty)
        baseline = self.fits.refined(self.fits.fit(()))
        finalists = self.weighing.finalists()
        best = finalists[0]
        posterior = self.weighing.posterior(best)
        values, errors = self._values(best, posterior)
        near = FittedModel((), Fit((), values, np.zeros(0), np.zeros((0, 0))))
        kin = self._kin(best, finalists)
        final = self._fitted(self._probable(best, finalists, kin), near)
        probabilities = self.weighing.probabilities(finalists)
        comparisons = Comparisons(self.fits, baseline, len(self.family.bends[0].terms), 0.0)
        kept = {candidate.key for candidate in final.candidates}
        return SearchResult(
            baseline,
            final,
            {c.key: self._evidence_for(c, final, finalists, self._kin_of(c, kin), comparisons) for c in final.candidates},
            {key: rivals for key, rivals in self._rivals(best, finalists).items() if key in kept},
            self._runners_up(best, posterior),
            probabilities=probabilities | self._of_poorer(final, best, kin, probabilities),
            errors={q: math.hypot(error, abs(values[q] - final.fit.values.get(q, values[q]))) for q, error in errors.items()},
        )

    def _values(self, best: Weighed, posterior: Posterior) -> tuple[dict[FreeParameter, float], dict[FreeParameter, float]]:
        """Return where the fit of the best subset starts, and the posterior standard deviation of its effects' parameters."""
        values = {q: q.start for q in self.fits.nuisances}
        for parameter, deviation in zip(self.family.nuisances, posterior.background, strict=True):
            assert parameter.prior is not None
            values[parameter] = parameter.prior[0] + parameter.prior[1] * float(deviation)
        errors: dict[FreeParameter, float] = {}
        first = 0
        for term in self.weighing.terms(best):
            sizes = posterior.sizes[first : first + term.columns.shape[1]]
            spread = posterior.errors[first : first + term.columns.shape[1]]
            first += term.columns.shape[1]
            before = dict(values)
            values |= term.parameters(sizes, before)
            for k in range(sizes.size):
                shifted = term.parameters(sizes + spread * (np.arange(sizes.size) == k), before)
                for parameter, value in shifted.items():
                    errors[parameter] = math.hypot(errors.get(parameter, 0.0), value - values[parameter])
        values |= self.family.bends[best.bend].values
        return {q: min(max(value, q.low), q.high) for q, value in values.items()}, errors

    def _kin(self, best: Weighed, finalists: Sequence[Weighed]) -> dict[At, set[At]]:
        """Return, for each effect of the best subset, itself, the others of its group, and what takes its place in other subsets."""
        rivals = self._rivals(best, finalists)
        groups = {term.candidate.at: term.group for bend in self.family.bends for term in bend.terms}
        found = {}
        for candidate in self.weighing.candidates(best):
            group = groups.get(candidate.at)
            alike = {at for at, other in groups.items() if group is not None and other == group}
            instead = {rival.at for rival, worse in rivals[candidate.key] if worse <= judgement.AS_GOOD}
            found[candidate.at] = {candidate.at} | alike | instead
        return found

    @staticmethod
    def _kin_of(candidate: Candidate, kin: Mapping[At, set[At]]) -> set[At]:
        """Return the kin of an effect of the final model, which may be a poorer form of one of the best subset."""
        return next((own for own in kin.values() if candidate.at in own), {candidate.at})

    def _probable(self, best: Weighed, finalists: Sequence[Weighed], kin: Mapping[At, set[At]]) -> tuple[Candidate, ...]:
        """Return the effects of the best subset that are probable enough to be named: each of them, or another of its kin."""
        candidates = self.weighing.candidates(best)
        groups = {term.candidate.at: term.group for term in self.weighing.terms(best)}
        probable = [c for c in candidates if self.weighing.probability_of_any(finalists, kin[c.at]) >= judgement.PROBABLE]
        return drop_orphans(probable, self.weighing.standing | {groups[c.at] for c in probable if c.at in groups})

    def _poorer_where_alike(self, candidates: tuple[Candidate, ...], values: Mapping[FreeParameter, float]) -> tuple[Candidate, ...]:
        """Return the effects, a richer form replaced by the poorer one where what it tells apart is alike."""
        known = {term.candidate.effect: term.candidate for term in self.family.bends[0].terms}
        found = []
        for candidate in candidates:
            effect = declared().get(candidate.effect)
            for poorer, parts in effect.absorbs if effect else ():
                apart = [values[q] for q in candidate.parameters if q.parameter in {mine for mine, _ in parts}]
                if poorer in known and apart and max(apart) - min(apart) < judgement.ALIKE * max(apart):
                    candidate = known[poorer]
            found.append(candidate)
        return tuple(found)

    def _of_poorer(
        self, final: FittedModel, best: Weighed, kin: Mapping[At, set[At]], probabilities: Mapping[At, float]
    ) -> dict[At, float]:
        """Return the probability of a poorer form that was put in the place of a richer one: that of either."""
        chosen = {c.at for c in self.weighing.candidates(best)}
        return {
            c.at: sum(probabilities.get(at, 0.0) for at in self._kin_of(c, kin)) for c in final.candidates if c.at not in chosen
        }

    def _fitted(self, candidates: tuple[Candidate, ...], near: FittedModel) -> FittedModel:
        """Return the fit of these effects; those that a healthy machine has as well are nuisance parameters."""
        while True:
            final = self.fits.refined(self.fits.fit(candidates, near))
            there = self._without_nil(candidates, final.fit.values)
            kept = self._poorer_where_alike(tuple(c for c in there if exceeds_healthy_limit(c, final)), final.fit.values)
            if kept == candidates:
                return final
            candidates = kept

    @staticmethod
    def _without_nil(candidates: tuple[Candidate, ...], values: Mapping[FreeParameter, float]) -> tuple[Candidate, ...]:
        """Return the effects without what the fit left nothing of; what came on top of such a one, and took its place, goes instead."""
        nil = {c.effect for c in candidates if all(abs(values[q] - q.neutral) <= NIL * q.scale for q in c.parameters)}
        usurping = tuple(c for c in candidates if c.prerequisite in nil)
        return tuple(c for c in candidates if c not in usurping) if usurping else tuple(c for c in candidates if c.effect not in nil)

    def _evidence_for(
        self, candidate: Candidate, final: FittedModel, finalists: Sequence[Weighed], kin: set[At], comparisons: Comparisons
    ) -> Evidence:
        """Return the evidence for an effect of the final model, its odds against the best subset with none of its kin."""
        without = self.fits.fit(final.without(candidate), final)
        found = comparisons.evidence(without, final)
        rest = [one.score for one in finalists if not kin & {c.at for c in self.weighing.candidates(one)}]
        lowest = min(one.score for one in finalists if one.score > -math.inf)
        return replace(found, log10_odds=(finalists[0].score - max(rest, default=lowest)) / math.log(10.0))

    def _rivals(self, best: Weighed, finalists: Sequence[Weighed]) -> dict[CandidateKey, list[tuple[Candidate, float]]]:
        """Return, for each effect, those that stand in its place in other subsets, and by how much these are less probable."""
        mine = {c.at: c for c in self.weighing.candidates(best)}
        groups = {term.candidate.at: term.group for bend in self.family.bends for term in bend.terms}
        groups = {**{bend.candidate.at: "" for bend in self.family.bends if bend.candidate is not None}, **groups}
        found: dict[CandidateKey, dict[At, tuple[Candidate, float]]] = {c.key: {} for c in mine.values()}
        for other in finalists[1:]:
            theirs = {c.at: c for c in self.weighing.candidates(other)}
            gone, new = set(mine) - set(theirs), set(theirs) - set(mine)
            if len(gone) != 1:
                continue
            (lost,) = gone
            taking = [theirs[at] for at in new if not theirs[at].is_law and (len(new) == 1 or groups[at] == groups[lost])]
            if len(taking) != 1:
                continue
            key, rival = mine[lost].key, taking[0]
            found[key].setdefault(rival.at, (rival, best.score - other.score))
        return {key: sorted(by.values(), key=lambda pair: pair[1]) for key, by in found.items()}

    def _runners_up(self, best: Weighed, posterior: Posterior) -> list[tuple[Candidate, float]]:
        """Return effects that are not in the best subset, with the share of what is left that each would explain."""
        inside = {c.at for c in self.weighing.candidates(best)}
        groups = {term.group for term in self.weighing.terms(best)}
        left = float(posterior.left @ posterior.left)
        found: dict[At, tuple[Candidate, float]] = {}
        for j, term in enumerate(self.family.bends[best.bend].terms):
            if term.candidate.at in inside or term.group in groups:
                continue
            more = self.weighing.posterior(best, (j,))
            share = max(1.0 - float(more.left @ more.left) / max(left, 1e-300), 0.0)
            if share > found.get(term.candidate.at, (term.candidate, -1.0))[1]:
                found[term.candidate.at] = term.candidate, share
        return sorted(found.values(), key=lambda pair: -pair[1])[:RUNNERS_UP]
