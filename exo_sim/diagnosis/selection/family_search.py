"""The search over a linear family: its most probable subset, fitted to the subsystem itself, with what speaks for and against each effect.

The terms of a family are linear only about where they were formed; the fit is not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey, drop_orphans
from exo_sim.diagnosis.estimation.linear_family import LinearFamily
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.budgets import RUNNERS_UP
from exo_sim.diagnosis.policy.off_nominal import HELD_WITHIN
from exo_sim.diagnosis.policy.recordings import FEWEST_ROWS
from exo_sim.diagnosis.policy.verdicts import NIL
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.evidence import Evidence
from exo_sim.diagnosis.selection.fitted_evidence import FittedEvidence
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult, exceeds_healthy_limit, is_more_than_healthy
from exo_sim.diagnosis.selection.laws import Law, errors_about
from exo_sim.diagnosis.selection.linear_evidence import Posterior, Spreads
from exo_sim.diagnosis.selection.marginal_fit import MarginalFits
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nonparametric_terms import nonparametric_terms, unnamed
from exo_sim.diagnosis.selection.refitted_finalists import Refitted, best_refitted
from exo_sim.diagnosis.selection.simpler_forms import (
    no_richer_than_needed,
    poorer_than,
    poorer_where_alike,
    richer_beside,
    sizes_of_poorer,
)
from exo_sim.diagnosis.selection.subset_weighing import At, SubsetWeighing, Weighed

Array = NDArray[np.float64]


class FamilySearch:
    """A search over one family.

    Args:
        fits: Fits of its subsystem.
        family: The family.
        basis: Of the discrepancy.
        standing: Effects that the nominal machine has anyhow.
    """

    def __init__(self, fits: ModelFits, family: LinearFamily, basis: DiscrepancyBasis, standing: Sequence[str] = ()):
        self.fits, self.family = fits, family
        self.basis = basis
        self.weighing = SubsetWeighing(family, basis, fits.model.blocks, standing, fits.is_spent)

    def run(self) -> SearchResult:
        """Weigh, fit and assess."""
        model = self.fits.model
        if model.size < FEWEST_ROWS:
            empty = FittedModel.at({})
            return SearchResult(empty, empty, weighed_together=True)
        baseline = self.fits.refined(self.fits.fit(()))
        finalists = self._findings_first(self.weighing.finalists())
        best, evidence = finalists[0], self._fitted_evidence
        posterior = self.weighing.posterior(best)
        values, _ = self._values(best, posterior)
        near = FittedModel.at(values)
        rivals, laws = self._rivals(best, finalists), self._laws(best, finalists)
        equivalents = self._equivalents(best, rivals)
        probable = self._probable(best, finalists, equivalents)
        chosen = no_richer_than_needed(probable, rivals)
        first = found = self._refitted(best, chosen, near)
        probabilities = self.weighing.probabilities(finalists)
        comparisons = Comparisons(self.fits, baseline, len(self.family.linearisations[0].terms), 0.0)
        exceeds = first.model.fit.sse > model.discrepancy_bound**2 * model.size
        if exceeds and not nonparametric_terms(self.weighing.terms(best)):
            found = best_refitted(first, finalists, self._names, self._refitted, lambda model: evidence.log_evidence(model, best.spreads))
        beside, final = found.beside, found.model
        if found is not first:
            probabilities |= {c.at: evidence.probability_in(c, final, best.spreads) for c in final.candidates}
        plain = self.fits.refined(self.fits.fit(final.candidates, final))
        final = self._predicting_best(final, plain, errors_about(final, laws))
        if final.candidates and comparisons.is_clean(baseline) and not evidence.is_decisive(final, baseline, best.spreads):
            final, plain = baseline, baseline
        rivals |= richer_beside(final.candidates, chosen, values)
        gone = [c for c in probable if c not in final.candidates and not c.is_law]
        passed_over = [c for c in gone if probabilities.get(c.at, 0.0) > verdicts.PROBABLE]
        kept = {candidate.key for candidate in final.candidates}
        return SearchResult(
            baseline,
            final,
            {
                c.key: self._evidence_for(c, final, beside, finalists, self._equivalents_of(c, equivalents), comparisons)
                for c in final.candidates
            },
            {key: those for key, those in rivals.items() if key in kept},
            self._runners_up(best, posterior),
            probabilities=probabilities | self._of_poorer(final, best, equivalents, probabilities),
            errors=errors_about(final, laws),
            unnamed=unnamed(self.weighing, self.basis, best, finalists, posterior),
            least_left=plain.fit.sse,
            undecided=tuple(c for c in passed_over if self._is_strained_without(c, probable, plain)),
            weighed_together=True,
        )

    @property
    def _fitted_evidence(self) -> FittedEvidence:
        return FittedEvidence(self.fits, self.basis, self.weighing.correlation_time)

    def _names(self, one: Weighed) -> tuple[Candidate, ...]:
        """Return what a subset names."""
        return tuple(c for c in self.weighing.candidates(one) if c.kind is not Kind.UNKNOWN)

    def _refitted(self, one: Weighed, chosen: tuple[Candidate, ...], near: FittedModel | None = None) -> Refitted:
        """Return names of a subset, fitted beside the discrepancy that they leave; begun at the subset's numbers, or `near`."""
        near = near or FittedModel.at(self._values(one, self.weighing.posterior(one))[0])
        spreads = self._widened(one, self._fitted_evidence.spreads_of(self.fits.fit(chosen, near), one.spreads))
        beside = MarginalFits(self.fits, self.basis, spreads, self.weighing.correlation_time)
        return Refitted(one, beside, self._fitted(chosen, near, beside))

    def _findings_first(self, finalists: list[Weighed]) -> list[Weighed]:
        """Return subsets, one first whose effects are all findings, of those about as probable as the best.

        What is within what healthy machines show is no finding, and must not take the place of one: a spring of a few N/m, slack far
        beyond the travel, pulls like the zero of a force sensor.
        """
        for one in finalists:
            if finalists[0].score - one.score > verdicts.AS_GOOD:
                break
            values, _ = self._values(one, self.weighing.posterior(one))
            model = FittedModel.at(values, tuple(self.weighing.candidates(one)))
            if all(c.kind is Kind.UNKNOWN or is_more_than_healthy(c, model) for c in model.candidates):
                return [one, *(other for other in finalists if other is not one)]
        return finalists

    def _is_strained_without(self, candidate: Candidate, probable: Sequence[Candidate], final: FittedModel) -> bool:
        """Return whether nuisance parameters stand in for an effect of the best subset: without it they are plainly further off."""
        kept = [c for c in probable if c.effect not in poorer_than(candidate.effect)]
        return final.fit.penalty - self.fits.fit(kept, final).fit.penalty > HELD_WITHIN**2

    def _widened(self, best: Weighed, spreads: Spreads) -> Spreads:
        """Return spreads with which what is missing without a name counts as discrepancy: no fit has numbers for it."""
        amplitudes = list(spreads.amplitudes)
        for _, term in nonparametric_terms(self.weighing.terms(best)):
            kind = self.basis.names.index(term.candidate.form)
            amplitudes[kind] = math.hypot(amplitudes[kind], float(term.spread[0]))
        return replace(spreads, amplitudes=tuple(amplitudes))

    def _laws(self, best: Weighed, finalists: Sequence[Weighed]) -> list[Law]:
        """Return every law that the effects of the best subset may follow, and may follow beside other effects, by how probable it is."""
        alike = self.weighing.alike(best, finalists)
        known, wanted = {(one.point, one.subset) for one in alike}, {c.at for c in self.weighing.candidates(best)}
        alike += [
            one for one in finalists
            if (one.point, one.subset) not in known and one.score > -math.inf and wanted & {c.at for c in self.weighing.candidates(one)}
        ]  # fmt: skip
        highest = max(one.score for one in alike)
        probable = [(math.exp(one.score - highest), one) for one in alike]
        return [
            Law(weight, one.point == best.point and one.subset == best.subset, *self._values(one, self.weighing.posterior(one)))
            for weight, one in probable
            if weight >= verdicts.LEAST_LAW_WEIGHT
        ]

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
        values |= self.family.linearisations[best.point].values
        return {q: min(max(value, q.low), q.high) for q, value in values.items()}, errors

    def _equivalents(self, best: Weighed, rivals: Mapping[CandidateKey, Sequence[tuple[Candidate, float]]]) -> dict[At, set[At]]:
        """Return, for each effect of the best subset, itself, the others of its group, and its rivals: what takes its place in others."""
        groups = {term.candidate.at: term.group for linear in self.family.linearisations for term in linear.terms}
        found = {}
        for candidate in self.weighing.candidates(best):
            group = groups.get(candidate.at)
            alike = {at for at, other in groups.items() if group is not None and other == group}
            instead = {rival.at for rival, worse in rivals[candidate.key] if worse <= verdicts.AS_GOOD}
            found[candidate.at] = {candidate.at} | alike | instead
        return found

    @staticmethod
    def _equivalents_of(candidate: Candidate, equivalents: Mapping[At, set[At]]) -> set[At]:
        """Return the equivalents of an effect of the final model, which may be a poorer form of one of the best subset."""
        return next((own for own in equivalents.values() if candidate.at in own), {candidate.at})

    def _probable(self, best: Weighed, finalists: Sequence[Weighed], equivalents: Mapping[At, set[At]]) -> tuple[Candidate, ...]:
        """Return the effects of the best subset that are probable enough to be named: each of them, or one of its equivalents."""
        candidates = [c for c in self.weighing.candidates(best) if c.kind is not Kind.UNKNOWN]
        groups = {term.candidate.at: term.group for term in self.weighing.terms(best)}
        least = verdicts.DECISIVE if nonparametric_terms(self.weighing.terms(best)) else verdicts.PROBABLE
        probable = [c for c in candidates if self.weighing.probability_of_any(finalists, equivalents[c.at]) >= least]
        return drop_orphans(probable, self.weighing.standing | {groups[c.at] for c in probable if c.at in groups})

    def _predicting_best(
        self, final: FittedModel, plain: FittedModel, known: Mapping[FreeParameter, float]
    ) -> FittedModel:
        """Return the plain fit where what was found beside the discrepancy does not speak against it.

        A rig holds no discrepancy: of numbers that the recording does not tell apart those are better that predict better without it.

        Args:
            final, plain: As found beside the discrepancy, and without it.
            known: Standard deviations of the parameters of the former.
        """
        near = all(abs(plain.fit.values[q] - final.fit.values[q]) <= known.get(q, math.inf) for q in final.effect_parameters)
        return plain if near else final

    def _of_poorer(
        self, final: FittedModel, best: Weighed, equivalents: Mapping[At, set[At]], probabilities: Mapping[At, float]
    ) -> dict[At, float]:
        """Return the probability of a poorer form that was put in the place of a richer one: that of either."""
        chosen = {c.at for c in self.weighing.candidates(best)}
        return {
            c.at: sum(probabilities.get(at, 0.0) for at in self._equivalents_of(c, equivalents))
            for c in final.candidates if c.at not in chosen
        }

    def _fitted(self, candidates: tuple[Candidate, ...], near: FittedModel, beside: MarginalFits) -> FittedModel:
        """Return the fit of these effects; those that a healthy machine has as well are nuisance parameters."""
        asked = {term.candidate.effect: term.candidate for term in self.family.linearisations[0].terms}
        while True:
            final = beside.fit(candidates, near, refined=True)
            there = self._without_nil(candidates, final.fit.values)
            kept = tuple(c for c in there if exceeds_healthy_limit(c, final))
            poorer = poorer_where_alike(kept, final.fit.values, asked)
            if poorer != kept:  # gains below the noise count for nothing
                begun = FittedModel.at({**final.fit.values, **sizes_of_poorer(kept, poorer, final.fit.values)})
                simpler = beside.fit(poorer, begun, refined=True)
                if simpler.fit.sse <= self.fits.model.size or beside.deficit(simpler, final) <= verdicts.AS_GOOD:
                    kept, near = poorer, begun
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
        self, candidate: Candidate, final: FittedModel, beside: MarginalFits, finalists: Sequence[Weighed], equivalents: set[At],
        comparisons: Comparisons,
    ) -> Evidence:
        """Return the evidence for an effect of the final model, its odds against the best subset with none of its equivalents."""
        without = beside.fit(final.without(candidate), final)
        found = comparisons.evidence(without, final)
        rest = [one.score for one in finalists if not equivalents & {c.at for c in self.weighing.candidates(one)}]
        lowest = min(one.score for one in finalists if one.score > -math.inf)
        return replace(found, log10_odds=(finalists[0].score - max(rest, default=lowest)) / math.log(10.0))

    def _rivals(self, best: Weighed, finalists: Sequence[Weighed]) -> dict[CandidateKey, list[tuple[Candidate, float]]]:
        """Return, for each effect, those that stand in its place in other subsets, and by how much these are less probable.

        Also what stands in the place of several at once: drag beside dry friction slows a swing as damping alone does.
        """
        mine = {c.at: c for c in self.weighing.candidates(best)}
        groups = {term.candidate.at: term.group for linear in self.family.linearisations for term in linear.terms}
        groups = {**{linear.candidate.at: "" for linear in self.family.linearisations if linear.candidate is not None}, **groups}
        found: dict[CandidateKey, dict[At, tuple[Candidate, float]]] = {c.key: {} for c in mine.values()}
        for other in finalists[1:]:
            theirs = {c.at: c for c in self.weighing.candidates(other)}
            gone, new = set(mine) - set(theirs), set(theirs) - set(mine)
            fewer = len(gone) > 1 and len(new) == 1 and all(_is_effect(mine[at]) for at in gone)  # one does what several do together
            for lost in gone if fewer or len(gone) == 1 else ():
                taking = [theirs[at] for at in new if _is_effect(theirs[at]) and (len(new) == 1 or groups[at] == groups[lost])]
                if len(taking) == 1:
                    found[mine[lost].key].setdefault(taking[0].at, (taking[0], best.score - other.score))
        return {key: sorted(by.values(), key=lambda pair: pair[1]) for key, by in found.items()}

    def _runners_up(self, best: Weighed, posterior: Posterior) -> list[tuple[Candidate, float]]:
        """Return effects that are not in the best subset, with the share of what is left that each would explain."""
        inside = {c.at for c in self.weighing.candidates(best)}
        groups = {term.group for term in self.weighing.terms(best)}
        left = float(posterior.left @ posterior.left)
        found: dict[At, tuple[Candidate, float]] = {}
        for j, term in enumerate(self.family.linearisations[best.point].terms):
            if term.candidate.at in inside or term.group in groups or not _is_effect(term.candidate):
                continue
            more = self.weighing.posterior(best, (j,))
            share = max(1.0 - float(more.left @ more.left) / max(left, 1e-300), 0.0)
            if share > found.get(term.candidate.at, (term.candidate, -1.0))[1]:
                found[term.candidate.at] = term.candidate, share
        return sorted(found.values(), key=lambda pair: -pair[1])[:RUNNERS_UP]


def _is_effect(candidate: Candidate) -> bool:
    """Return whether a candidate is an effect of the list: neither a law of one nor what has no name."""
    return not candidate.is_law and candidate.kind is not Kind.UNKNOWN
