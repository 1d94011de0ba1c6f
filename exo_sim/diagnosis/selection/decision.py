"""From the search over one subsystem to its result: what is named, with which intervals and rivals, and whether something is unknown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Generic, TypeVar

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH, bounded_interval
from exo_sim.diagnosis.findings import Finding, Kind, Rejected
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.acceptance import BESIDE_DISCREPANCY, CLEAN, STEADY_GAIN, SURELY_MORE
from exo_sim.diagnosis.selection.beside_curve import needed_beside_curve
from exo_sim.diagnosis.selection.candidate_finding import (
    finding_of,
    with_all_parts,
    with_openness_of_law,
    with_twins,
    with_what_it_counts_from,
)
from exo_sim.diagnosis.selection.fitted_model import (
    FittedModel,
    SearchResult,
    exceeds_healthy_limit,
    is_at_bound,
    is_more_than_healthy,
)
from exo_sim.diagnosis.selection.held_out_gain import gain_in_errors
from exo_sim.diagnosis.selection.left_out import left_out
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nuisance_calibration import Deviation, deviations, refitted_besides
from exo_sim.diagnosis.selection.remainder import Remainder, has_bursts
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unneeded_nuisances import without_unneeded
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.declaration import identification_of

Model = TypeVar("Model", bound=SubsystemModel)


def decide(name: str, model: Model, fits: ModelFits, search: SearchResult, split: Split | None = None) -> SubsystemResult[Model]:
    """Return the result of a finished search; of an interrupted one, what other subsystems need to go on.

    Args:
        name: What identifies the subsystem among those of its kind.
        model, fits, search: What was searched, and what was found.
        split: Of the time, its validation time held out; without one no name stands beside something unknown in a gas.
    """
    return _Decision(model, fits, _off_bounds(fits, search), split).result(name)


def _off_bounds(fits: ModelFits, search: SearchResult) -> SearchResult:
    """Return a search whose final model has nothing in it that ended at a bound: what that explained has no name."""
    end = search.final
    while not search.interrupted:
        kept = drop_orphans([c for c in end.candidates if not is_at_bound(c, end)])
        if len(kept) == len(end.candidates):
            break
        end = fits.refined(fits.fit(kept, end))
    return search if end is search.final else replace(search, final=end)


class _Decision(Generic[Model]):
    """The decision on one search: which candidates are findings, and whether something is unknown beside them."""

    def __init__(self, model: Model, fits: ModelFits, search: SearchResult, split: Split | None):
        self.model, self.fits, self.search, self.split = model, fits, search, split

    def result(self, name: str) -> SubsystemResult[Model]:
        search, end = self.search, self.search.final
        empty = SubsystemResult(name, self.model, self.fits, search, end)
        if end.fit.residual.size == 0:
            return empty
        if search.interrupted:
            return replace(empty, named=end.candidates)
        accepted = tuple(c for c in end.candidates if not _is_nozzle(c, end))
        standing, stands, unknown = self._standing(accepted)
        strict = unknown and not search.weighed_together  # then only what is beyond doubt is a finding
        sure, named = self._sure(standing, stands, unknown, strict)
        by_fit = self._errors_by_fit(sure)
        errors = self._with_form(sure, by_fit)
        spare = not unknown and not search.weighed_together
        final = without_unneeded(self.fits, sure, self.model.structural_error) if spare else sure
        reported = tuple(c for c in named if _is_reported(c, final, errors) and self._is_surely_there_beneath(c, final))
        laws = {q for c in named if c not in reported for q in c.parameters}
        findings = self._findings(reported, final, errors, strict)
        observed = {parameter: error for parameter, error in errors.items() if self.model.is_observed(parameter)}
        by_fit = {parameter: by_fit[parameter] for parameter in observed}
        off = () if strict else self._deviations(final, observed, by_fit)  # what has no name biases them
        besides = refitted_besides(final, by_fit, {one.parameter for one in off}, bool(reported or laws))
        return replace(
            empty, final=final, named=reported, has_unknown=unknown, findings=findings, deviations=off,
            rejected=_without_repetition(self._rejected(accepted, strict), findings),
            refitted=besides + tuple((q, errors[q]) for q in errors if q in laws),
        )  # fmt: skip

    def _sure(
        self, standing: FittedModel, stands: tuple[Candidate, ...], unknown: bool, strict: bool
    ) -> tuple[FittedModel, tuple[Candidate, ...]]:
        """Return the model and the findings of it that may be named, where something is unknown beside them fewer than those that stand."""
        if strict:
            return self._beyond_doubt(standing, stands)
        return self._surely_there(standing, stands) if unknown else (standing, stands)

    def _findings(
        self, reported: Sequence[Candidate], final: FittedModel, errors: Mapping[FreeParameter, float], strict: bool
    ) -> tuple[Finding, ...]:
        """Return the findings with their parameters, their probability, and what looks the same."""
        own = self.fits.standard_errors(final) if self.search.reach else {}
        plain = [with_all_parts(finding_of(c, final, errors, self.search), c, self.search, self.fits) for c in reported]
        plain = [with_openness_of_law(f, c, self.search, own) for f, c in zip(plain, reported, strict=True)]
        plain = [with_what_it_counts_from(f, final) for f in plain]
        most = float(verdicts.CONFIDENT_BESIDE_UNKNOWN)
        bounded = [replace(f, probability=min(f.confidence, most)) for f in plain] if strict else plain
        twins = self.model.indistinguishable(bounded, final.fit)
        return tuple(with_twins(f, twins.get(f.at, ())) for f in bounded)

    def _deviations(
        self, final: FittedModel, observed: Mapping[FreeParameter, float], by_fit: Mapping[FreeParameter, float]
    ) -> tuple[Deviation, ...]:
        """Return nominal numbers that are off, with what they may stand for; arguments as of `deviations`."""
        return tuple(
            replace(
                one, stands_for=self.search.stands_for.get((one.parameter.effect, one.parameter.where), ()),
                twins=self.model.twins_of_number(one.parameter),
            )
            for one in deviations(final, observed, by_fit)
        )  # fmt: skip

    def _errors(self, final: FittedModel) -> dict[FreeParameter, float]:
        """Return the standard errors of a model's parameters: by its fit, and by what the form of its equations leaves open."""
        return self._with_form(final, self._errors_by_fit(final))

    def _with_form(self, final: FittedModel, by_fit: Mapping[FreeParameter, float]) -> dict[FreeParameter, float]:
        """Return the standard errors of a model's fit with what the form of its equations leaves open beside them."""
        values, fixed = final.fit.values, final.fixed
        return {q: math.hypot(error, self.model.error_of_form(q, error, values, fixed)) for q, error in by_fit.items()}

    def _errors_by_fit(self, final: FittedModel) -> dict[FreeParameter, float]:
        """Return the standard errors of a model's parameters: those of its fit, or where they are larger those of the search."""
        searched = self.search.errors
        return {q: max(error, searched.get(q, 0.0)) for q, error in self.fits.standard_errors(final).items()}

    def _standing(self, accepted: tuple[Candidate, ...]) -> tuple[FittedModel, tuple[Candidate, ...], bool]:
        """Return the model and the findings that stand in it, and whether something is unknown beside them."""
        end = self.search.final
        unknown = self._remainder(end, accepted).is_unknown
        if not self.model.demands_larger_part or unknown or end.fit.sse <= CLEAN * self.model.size:
            return end, accepted, unknown
        final, named = self._with_larger_part(accepted)
        return final, named, named != accepted and self._remainder(final, named).is_unknown

    def _is_surely_there_beneath(self, candidate: Candidate, final: FittedModel) -> bool:
        """Return whether an effect is surely more than healthy by itself where a law adds parts to it, by the mean of them.

        Four edges that differ come on top of a dead band; whether that is there beneath them their mean says.
        """
        for law in (c for c in final.candidates if c.is_law and c.prerequisite == candidate.effect):
            own, parts = identification_of(law.effect).common
            added = [q for q in law.parameters if q.parameter in parts]
            q = next((q for q in candidate.parameters if q.parameter == own), None)
            if q is None or not added:
                continue
            weights = {q: 1.0, **dict.fromkeys(added, 1.0 / len(added))}
            mean = sum(weight * final.fit.values[one] for one, weight in weights.items())
            if abs(mean - q.neutral) - SURELY_MORE * self.fits.error_of_sum(final, weights) <= q.healthy_limit:
                return False
        return True

    def _rejected(self, accepted: Sequence[Candidate], strict: bool) -> list[Rejected]:
        search = self.search
        found = [
            Rejected(*rival.at, wording.rejected(rival, c, worse))
            for c in accepted
            if not c.is_law  # nobody reads of a law what stands in its place
            for rival, worse in search.rivals.get(c.key, [])
            if worse > verdicts.AS_GOOD
        ]
        found += [Rejected(*c.at, wording.STRAINING) for c in search.straining]
        found += [Rejected(*c.at, wording.no_gain(c, share)) for c, share in search.runners_up]
        if strict:
            found += [
                Rejected(*c.at, wording.unsure_beside_unknown(search.evidence[c.key].share))
                for c in accepted
                if c.key in search.evidence
            ]
        return found

    def _beyond_doubt(self, final: FittedModel, named: tuple[Candidate, ...]) -> tuple[FittedModel, tuple[Candidate, ...]]:
        """Return the findings that stand beside an unknown effect, and the model with nothing but them."""
        end = self.search.final
        apart = self._borne_out([c for c in named if self._may_stand_alone(c)])
        kept = drop_orphans([c for c in apart if identification_of(c.effect).applicability.bursts or not has_bursts(self.model, end)])
        if not kept or self._kept_back is None:
            return self.search.baseline, kept
        beside = final if kept == named else self.fits.fit(kept, end)
        return needed_beside_curve(self.model, self._kept_back, lambda chosen: self.fits.fit(chosen, end), beside, kept)

    def _surely_there(self, final: FittedModel, named: tuple[Candidate, ...]) -> tuple[FittedModel, tuple[Candidate, ...]]:
        """Return the findings whose intervals hold nothing that a healthy machine shows, and the model with them.

        The others are biased by what is unknown beside them.
        """
        errors = self._errors(final)
        firm = drop_orphans([c for c in named if c.is_law or exceeds_healthy_limit(c, final, errors, HALF_WIDTH)])
        return (final, named) if firm == named else (self.fits.refined(self.fits.fit(firm, final)), firm)

    def _with_larger_part(self, named: tuple[Candidate, ...]) -> tuple[FittedModel, tuple[Candidate, ...]]:
        """Return the findings that explain the larger part and surely exceed what a healthy machine shows, and the model with them."""
        final = self.search.final
        while named:
            errors = self.fits.standard_errors(final)
            firm = drop_orphans(
                [
                    c for c in named
                    if self._takes_larger_part(c) and is_more_than_healthy(c, final, None if self._is_plain(c) else errors)
                ]
            )  # fmt: skip
            if firm == named:
                break
            final, named = self.fits.refined(self.fits.fit(firm, final)), firm
        return final, named

    def _takes_larger_part(self, candidate: Candidate) -> bool:
        """Return whether a finding explains the larger part of what is missing without it, or has a shape of its own.

        The latter does not do for a sensor: what is left of a machine biases zeros, scales and delays first.
        """
        evidence = self.search.evidence.get(candidate.key)
        if evidence is None:
            return True
        apart = evidence.beside_discrepancy > BESIDE_DISCREPANCY and candidate.kind is not Kind.SENSOR
        return apart or evidence.share > verdicts.LARGER_PART

    def _is_plain(self, candidate: Candidate) -> bool:
        """Return whether the odds leave no doubt: a parameter is then vague only because nuisance parameters could stand in for it."""
        evidence = self.search.evidence.get(candidate.key)
        return evidence is not None and max(evidence.log10_odds, evidence.beside_discrepancy) > verdicts.PLAIN_ODDS

    def _may_stand_alone(self, candidate: Candidate) -> bool:
        """Return whether the odds of a finding, beside all others, leave no doubt although something else is left.

        That does not do for a sensor: what is left of a machine biases zeros, scales and delays first, at all times.
        """
        return candidate.kind is not Kind.SENSOR and self._is_plain(candidate)

    def _borne_out(self, asked: Sequence[Candidate]) -> tuple[Candidate, ...]:
        """Return the findings with which held-out time is predicted better, block for block, than without each of them.

        The one that is missed least is left out first, and the others asked anew: of effects that stand in for each other none is missed
        beside all the others.

        Args:
            asked: Findings of the search; what else it ended with stays beside them.
        """
        kept, model = list(asked), self.search.final
        while kept and self._kept_back is not None and self._kept_back.size:
            gains = {candidate.key: self._held_out_gain(candidate, model) for candidate in kept}
            least = min(kept, key=lambda candidate: gains[candidate.key])
            if gains[least.key] > STEADY_GAIN:
                return tuple(kept)
            model = self.fits.fit(drop_orphans(model.without(least)), model)
            kept = [candidate for candidate in kept if candidate in model.candidates]
        return ()

    def _held_out_gain(self, candidate: Candidate, model: FittedModel) -> float:
        """Return by how much a candidate lowers the held-out error of a model, in standard errors of that over blocks."""
        assert self._kept_back is not None
        both = (left_out(candidate, model, self.fits).model, model)
        return gain_in_errors(self._kept_back, *(self._kept_back.residual(one.fit.values, one.fixed) for one in both))

    @cached_property
    def _kept_back(self) -> SubsystemModel | None:
        """The subsystem over validation time."""
        if self.split is None or not self.split.validation:
            return None
        return self.model.on_test_time(self.split.validation_as_test())

    def _remainder(self, final: FittedModel, named: Sequence[Candidate]) -> Remainder:
        return Remainder(self.model, self.fits, self.search, final, named)


def _is_reported(candidate: Candidate, model: FittedModel, errors: Mapping[FreeParameter, float]) -> bool:
    """Return whether a candidate is a finding.

    Not a law within what healthy machines show, nor what only bears such a law, nor a sensor whose fault is not sure, whatever its odds:
    it stands in for what is not modelled. So may a slow leak, which adds up over the recording as the form of heat does and a sensor's
    gain: its interval must lie beyond what healthy seals lose. `errors` are standard errors.
    """
    if candidate.kind is Kind.SENSOR and not exceeds_healthy_limit(candidate, model, errors):
        return False
    if identification_of(candidate.effect).leaks and not exceeds_healthy_limit(candidate, model, errors, HALF_WIDTH):
        return False
    bears = any(c.is_law and c.prerequisite == candidate.effect for c in model.candidates)
    if not candidate.is_law:
        return (not bears or exceeds_healthy_limit(candidate, model)) and not _may_be_of_any_contact(candidate, model, errors)
    return any(q.healthy_limit > 0.0 for q in candidate.parameters) and exceeds_healthy_limit(candidate, model)


def _may_be_of_any_contact(candidate: Candidate, model: FittedModel, errors: Mapping[FreeParameter, float]) -> bool:
    """Return whether the interval of a number that every contact has reaches its bound, where any machine's begins."""
    name = identification_of(candidate.effect).every_contact
    asked = [q for q in candidate.parameters if name and q.parameter == name]
    return any(bounded_interval(q, model.fit.values[q], errors.get(q, 0.0))[1] >= q.high for q in asked)


def _is_nozzle(candidate: Candidate, model: FittedModel) -> bool:
    if candidate.is_law or not identification_of(candidate.effect).every_law:
        return False
    return model.fit.values[candidate.parameters[0]] > verdicts.NOZZLE_LOW


def _without_repetition(rejected: Sequence[Rejected], findings: Sequence[Finding]) -> tuple[Rejected, ...]:
    """Return each rejected candidate once, and none that a finding names."""
    named = {(name, f.where) for f in findings for name in (f.name, *f.ambiguous_with)}
    first: dict[tuple[str, str], Rejected] = {}
    for one in rejected:
        if one.at not in named:
            first.setdefault(one.at, one)
    return tuple(first.values())
