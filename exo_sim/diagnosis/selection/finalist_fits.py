"""Fits of what a subset of a linear family names, beside the discrepancy that the subset leaves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy.verdicts import NIL
from exo_sim.diagnosis.selection.fitted_evidence import FittedEvidence
from exo_sim.diagnosis.selection.fitted_model import FittedModel, exceeds_healthy_limit
from exo_sim.diagnosis.selection.left_by_names import leave_nothing
from exo_sim.diagnosis.selection.linear_evidence import Spreads
from exo_sim.diagnosis.selection.marginal_fit import MarginalFits
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nonparametric_terms import nonparametric_terms
from exo_sim.diagnosis.selection.refitted_finalists import Refitted
from exo_sim.diagnosis.selection.simpler_forms import in_poorer_forms
from exo_sim.diagnosis.selection.subset_numbers import values_and_errors
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing, Weighed


class FinalistFits:
    """Fits of the names of weighed subsets.

    Args:
        fits: Fits of the subsystem.
        weighing: Of the subsets, done.
        basis: Of the discrepancy.
    """

    def __init__(self, fits: ModelFits, weighing: SubsetWeighing, basis: DiscrepancyBasis):
        self.fits, self.weighing, self.basis = fits, weighing, basis

    @property
    def evidence(self) -> FittedEvidence:
        """The evidence for models that were fitted as they act."""
        return FittedEvidence(self.fits, self.basis, self.weighing.correlation_time)

    def refitted(self, one: Weighed, chosen: tuple[Candidate, ...], near: FittedModel | None = None) -> Refitted:
        """Return names of a subset, fitted beside the discrepancy that they leave; begun at the subset's numbers, or `near`."""
        if near is None:
            near = FittedModel.at(values_and_errors(self.weighing, self.fits.nuisances, one, self.weighing.posterior(one))[0])
        spreads = self._widened(one, self.evidence.spreads_of(self.fits.fit(chosen, near), one.spreads))
        found = self._beside(one, spreads, chosen, near)
        return self._by_names_alone(found) if found.model.candidates and nonparametric_terms(self.weighing.terms(one)) else found

    def _beside(self, one: Weighed, spreads: Spreads, chosen: tuple[Candidate, ...], near: FittedModel) -> Refitted:
        """Return names fitted beside a discrepancy of these spreads."""
        beside = MarginalFits(self.fits, self.basis, spreads, self.weighing.correlation_time)
        return Refitted(one, beside, self._fitted(chosen, near, beside))

    def _by_names_alone(self, found: Refitted) -> Refitted:
        """Return names fitted without what their subset has beside them and has no name, where they leave none of that.

        A subset has its names at the shapes where they were linearised. A bump of friction at another place of the stroke is then a curve
        of place beside its own name; fitted as it acts the name leaves nothing to the curve.
        """
        alone = self.fits.fit(found.model.candidates, found.model)
        terms = tuple(term for _, term in nonparametric_terms(self.weighing.terms(found.weighed)))
        whole, is_spent = self.weighing.family.whole, self.fits.is_spent
        if not leave_nothing(alone.fit, terms, self.basis, self.fits.model.blocks, whole, is_spent):
            return found
        again = self._beside(found.weighed, self.evidence.spreads_of(alone, found.weighed.spreads), found.model.candidates, alone)
        return replace(again, names_suffice=again.model.candidates == found.model.candidates)

    def _widened(self, one: Weighed, spreads: Spreads) -> Spreads:
        """Return spreads with which what is missing without a name counts as discrepancy: no fit has numbers for it."""
        amplitudes = list(spreads.amplitudes)
        for _, term in nonparametric_terms(self.weighing.terms(one)):
            kind = self.basis.names.index(term.candidate.form)
            amplitudes[kind] = math.hypot(amplitudes[kind], float(term.spread[0]))
        return replace(spreads, amplitudes=tuple(amplitudes))

    def _fitted(self, candidates: tuple[Candidate, ...], near: FittedModel, beside: MarginalFits) -> FittedModel:
        """Return the fit of these effects; those that a healthy machine has as well are nuisance parameters."""
        asked = self.weighing.family.by_effect
        while True:
            final = beside.fit(candidates, near, refined=True)
            there = without_nil(candidates, final.fit.values)
            kept = tuple(c for c in there if exceeds_healthy_limit(c, final))
            simpler = in_poorer_forms(
                final, kept, asked, self.weighing.family.constant, lambda names, begun: beside.fit(names, begun, refined=True),
                beside.deficit, self.fits.model.size,
            )  # fmt: skip
            if simpler is not final:
                kept, near = simpler.candidates, simpler
            if kept == candidates:
                return final
            candidates = kept


def without_nil(candidates: tuple[Candidate, ...], values: Mapping[FreeParameter, float]) -> tuple[Candidate, ...]:
    """Return the effects without what a fit left nothing of; what came on top of such a one, and took its place, goes instead."""
    nil = {c.effect for c in candidates if all(abs(values[q] - q.neutral) <= NIL * q.scale for q in c.parameters)}
    usurping = tuple(c for c in candidates if c.prerequisite in nil)
    return tuple(c for c in candidates if c not in usurping) if usurping else tuple(c for c in candidates if c.effect not in nil)


def predicting_best(final: FittedModel, plain: FittedModel, known: Mapping[FreeParameter, float]) -> FittedModel:
    """Return the plain fit where what was found beside the discrepancy does not speak against it.

    A rig holds no discrepancy: of numbers that the recording does not tell apart those are better that predict better without it.

    Args:
        final, plain: As found beside the discrepancy, and without it.
        known: Standard deviations of the parameters of the former.
    """
    near = all(abs(plain.fit.values[q] - final.fit.values[q]) <= known.get(q, math.inf) for q in final.effect_parameters)
    return plain if near else final
