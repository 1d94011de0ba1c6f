"""The search over a linear family: its most probable subset, fitted to the subsystem itself, with what speaks for and against each effect.

The terms of a family are linear only about where they were formed; the fit is not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.linear_family import LinearFamily
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.off_nominal import HELD_WITHIN
from exo_sim.diagnosis.policy.recordings import FEWEST_ROWS
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.evidence import Evidence
from exo_sim.diagnosis.selection.family_rivals import equivalents, equivalents_of, rivals, runners_up
from exo_sim.diagnosis.selection.finalist_fits import FinalistFits, predicting_best
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult, is_more_than_healthy, key_of
from exo_sim.diagnosis.selection.law_forms import as_fitted, fitted_forms, plainest, weighed_as_fitted
from exo_sim.diagnosis.selection.laws import errors_about, reach_of_laws, reaching
from exo_sim.diagnosis.selection.marginal_fit import MarginalFits
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nested_fits import no_worse_than_nested
from exo_sim.diagnosis.selection.nonparametric_terms import nonparametric_terms, unnamed
from exo_sim.diagnosis.selection.refitted_finalists import Refitted, best_form, best_refitted, poorer_forms_first
from exo_sim.diagnosis.selection.simpler_forms import no_richer_than_needed, poorer_than, richer_beside, rivals_of_either
from exo_sim.diagnosis.selection.straining import without_straining
from exo_sim.diagnosis.selection.subset_numbers import laws_of, values_and_errors
from exo_sim.diagnosis.selection.subset_weighing import At, SubsetWeighing, Weighed


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
        self.finalist_fits = FinalistFits(fits, self.weighing, basis)

    def run(self) -> SearchResult:
        """Weigh, fit and assess."""
        model = self.fits.model
        if model.size < FEWEST_ROWS:
            empty = FittedModel.at({})
            return SearchResult(empty, empty, weighed_together=True)
        baseline = self.fits.refined(self.fits.fit(()))
        finalists = self._findings_first(self.weighing.finalists())
        best, evidence = finalists[0], self.finalist_fits.evidence
        posterior = self.weighing.posterior(best)
        values, _ = values_and_errors(self.weighing, self.fits.nuisances, best, posterior)
        near = FittedModel.at(values)
        taking = rivals(self.weighing, best, finalists)
        laws = laws_of(self.weighing, self.fits.nuisances, best, finalists)
        alike = equivalents(self.weighing, best, taking)
        probable = self._probable(best, finalists, alike)
        chosen = no_richer_than_needed(probable, taking)
        first = found = self.finalist_fits.refitted(best, chosen, near)
        probabilities = self.weighing.probabilities(finalists)
        comparisons = Comparisons(self.fits, baseline, len(self.family.linearisations[0].terms), 0.0)
        most = model.discrepancy_bound**2 * model.size
        exceeds = first.model.fit.sse > min(most, verdicts.LOST * max(self.weighing.square_left(posterior), model.size))
        if exceeds and not nonparametric_terms(self.weighing.terms(best)):
            found, others = self._as_it_acts(first, finalists, most)
            if found is not first:  # what was more probable along lines does not fit as it acts
                laws = laws_of(self.weighing, self.fits.nuisances, found.weighed, others)
        beside = found.beside
        final = no_worse_than_nested(
            found.model, lambda chosen, near, again: beside.fit(chosen, near, refined=True, again=again), beside.deficit
        )
        if found is not first:
            probabilities |= {c.at: evidence.probability_in(c, final, best.spreads) for c in final.candidates}
        forms = fitted_forms(
            final, self._forms(), lambda chosen, near: beside.fit(chosen, near, refined=True),
            lambda one: evidence.log_evidence(one, best.spreads),
        )  # fmt: skip
        final = plainest(forms)
        if found.names_suffice:  # the subset had a part of them without a name, and its numbers are of the rest
            laws = [as_fitted(final, self.fits.standard_errors(final))]
        laws = weighed_as_fitted(laws, forms, final, self.fits.standard_errors)
        plain = self.fits.refined(self.fits.fit(final.candidates, final, again=final is not found.model))
        final = predicting_best(final, plain, errors_about(final, laws))
        relaxed = without_straining(plain, self.fits, self.family.by_effect)
        straining = tuple(c for c in plain.candidates if c not in relaxed.candidates and not c.is_law)
        if relaxed is not plain:
            final = plain = relaxed
        if final.candidates and comparisons.is_clean(baseline) and not evidence.is_decisive(final, baseline, best.spreads):
            final, plain = baseline, baseline
        both = FittedModel.at({**values, **final.fit.values})
        richer = richer_beside(
            final, probable if found is first else (), lambda chosen: beside.fit(chosen, both, refined=True),
            lambda one: evidence.log_evidence(one, best.spreads),
        )  # fmt: skip
        taking = rivals_of_either(richer, taking)
        gone = [c for c in probable if c not in final.candidates and not c.is_law]
        passed_over = [c for c in gone if probabilities.get(c.at, 0.0) > verdicts.PROBABLE]
        kept = {candidate.key for candidate in final.candidates}
        return SearchResult(
            baseline,
            final,
            {
                c.key: self._evidence_for(c, final, beside, finalists, equivalents_of(c, alike), comparisons)
                if found is first else self._evidence_as_fitted(c, final, beside, best, comparisons)
                for c in final.candidates
            },
            {key: those for key, those in taking.items() if key in kept},
            runners_up(self.weighing, best, posterior),
            probabilities=probabilities | self._of_poorer(final, best, alike, probabilities),
            errors=errors_about(final, laws),
            reach=reaching(reach_of_laws(final, laws), final, [form.numbers for form in richer.values()]),
            unnamed=() if found.names_suffice else unnamed(self.weighing, self.basis, best, finalists, posterior),
            least_left=plain.fit.sse,
            undecided=tuple(c for c in passed_over if self._is_strained_without(c, probable, plain)),
            straining=straining,
            weighed_together=True,
        )

    def _as_it_acts(self, first: Refitted, finalists: Sequence[Weighed], most: float) -> tuple[Refitted, list[Weighed]]:
        """Return the subset that leaves least where it is fitted, and those that no fit speaks against.

        Args:
            first: The most probable one, fitted: it leaves too much.
            finalists: All of them.
            most: The largest sum of squares of a healthy machine: of what leaves more each form is fitted.
        """
        fitted = {key_of(first.model.candidates), key_of(self._names(first.weighed))}

        def refit(one: Weighed, names: tuple[Candidate, ...]) -> Refitted:
            fitted.add(key_of(names))
            return self.finalist_fits.refitted(one, names)

        def log_evidence(model: FittedModel) -> float:
            return self.finalist_fits.evidence.log_evidence(model, first.weighed.spreads)

        found = best_refitted(first, poorer_forms_first(finalists, self._names), self._names, refit, log_evidence)
        if found.model.fit.sse > most:
            found = best_form(found, self._alike(found.weighed, finalists), self._names, refit, log_evidence)
        return found, [one for one in finalists if key_of(self._names(one)) not in fitted]

    def _forms(self) -> tuple[Candidate, ...]:
        """Return every form of every effect that the family has."""
        weighed = {term.candidate.key: term.candidate for term in self.family.linearisations[0].terms}
        return (*weighed.values(), *self.family.fitted_forms)

    def _names(self, one: Weighed) -> tuple[Candidate, ...]:
        """Return what a subset names."""
        return tuple(c for c in self.weighing.candidates(one) if c.kind is not Kind.UNKNOWN)

    def _alike(self, best: Weighed, finalists: Sequence[Weighed]) -> list[Weighed]:
        """Return the subsets with the effects of one, however a contact begins to slide, the most probable first."""
        own = {c.at for c in self._names(best) if not c.is_law}
        alike = (one for one in self.weighing.alike(best, finalists) if {c.at for c in self._names(one) if not c.is_law} == own)
        return sorted(alike, key=lambda one: -one.score)

    def _findings_first(self, finalists: list[Weighed]) -> list[Weighed]:
        """Return subsets, one first whose effects are all findings, of those about as probable as the best.

        What is within what healthy machines show is no finding, and must not take the place of one: a spring of a few N/m, slack far
        beyond the travel, pulls like the zero of a force sensor.
        """
        for one in finalists:
            if finalists[0].score - one.score > verdicts.AS_GOOD:
                break
            values, _ = values_and_errors(self.weighing, self.fits.nuisances, one, self.weighing.posterior(one))
            model = FittedModel.at(values, tuple(self.weighing.candidates(one)))
            if all(c.kind is Kind.UNKNOWN or is_more_than_healthy(c, model) for c in model.candidates):
                return [one, *(other for other in finalists if other is not one)]
        return finalists

    def _is_strained_without(self, candidate: Candidate, probable: Sequence[Candidate], final: FittedModel) -> bool:
        """Return whether nuisance parameters stand in for an effect of the best subset: without it they are plainly further off."""
        kept = [c for c in probable if c.effect not in poorer_than(candidate.effect)]
        return final.fit.penalty - self.fits.fit(kept, final).fit.penalty > HELD_WITHIN**2

    def _probable(self, best: Weighed, finalists: Sequence[Weighed], alike: Mapping[At, set[At]]) -> tuple[Candidate, ...]:
        """Return the effects of the best subset that are probable enough to be named: each of them, or one of its equivalents."""
        candidates = [c for c in self.weighing.candidates(best) if c.kind is not Kind.UNKNOWN]
        groups = {term.candidate.at: term.group for term in self.weighing.terms(best)}
        least = verdicts.DECISIVE if nonparametric_terms(self.weighing.terms(best)) else verdicts.PROBABLE
        probable = [c for c in candidates if self.weighing.probability_of_any(finalists, alike[c.at]) >= least]
        return drop_orphans(probable, self.weighing.standing | {groups[c.at] for c in probable if c.at in groups})

    def _of_poorer(
        self, final: FittedModel, best: Weighed, alike: Mapping[At, set[At]], probabilities: Mapping[At, float]
    ) -> dict[At, float]:
        """Return the probability of a poorer form that was put in the place of a richer one: that of either."""
        chosen = {c.at for c in self.weighing.candidates(best)}
        return {
            c.at: sum(probabilities.get(at, 0.0) for at in equivalents_of(c, alike))
            for c in final.candidates if c.at not in chosen
        }

    def _evidence_for(
        self, candidate: Candidate, final: FittedModel, beside: MarginalFits, finalists: Sequence[Weighed], alike: set[At],
        comparisons: Comparisons,
    ) -> Evidence:
        """Return the evidence for an effect of the final model, its odds against the best subset with none of its equivalents."""
        without = beside.fit(final.without(candidate), final)
        found = comparisons.evidence(without, final)
        rest = [one.score for one in finalists if not alike & {c.at for c in self.weighing.candidates(one)}]
        lowest = min(one.score for one in finalists if one.score > -math.inf)
        return replace(found, log10_odds=(finalists[0].score - max(rest, default=lowest)) / math.log(10.0))

    def _evidence_as_fitted(
        self, candidate: Candidate, final: FittedModel, beside: MarginalFits, best: Weighed, comparisons: Comparisons
    ) -> Evidence:
        """Return the evidence for an effect of a model that was not the most probable one along lines: of fits with it and without."""
        without = beside.fit(drop_orphans(final.without(candidate)), final)
        gain = [self.finalist_fits.evidence.log_evidence(one, best.spreads) for one in (final, without)]
        return replace(comparisons.evidence(without, final), log10_odds=(gain[0] - gain[1]) / math.log(10.0))
