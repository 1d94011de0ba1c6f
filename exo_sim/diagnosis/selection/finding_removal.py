"""Findings put aside: what is left of a result is fitted and decided once more, for its numbers were found beside them."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.findings import Estimate, Finding
from exo_sim.diagnosis.policy.probability import LEAST_PROBABILITY
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.nuisance_calibration import counted_back
from exo_sim.diagnosis.selection.simpler_forms import in_poorer_forms, poorer_than, sizes_of_poorer
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel

Model = TypeVar("Model", bound=SubsystemModel)


def without_findings(
    result: SubsystemResult[Model], names: Collection[tuple[str, str]], split: Split | None = None
) -> SubsystemResult[Model]:
    """Return a result without some of its findings and what comes on top of them.

    A poorer form of one that explained nearly as much takes its place: where two levels of friction may be one, friction is still there.
    Where the rest alone would leave something unknown, its numbers stay as they were found: only the names go, and a dead volume in which
    an owner had counted a hose holds it again.

    Args:
        result: A result.
        names: Effect and place of each.
        split: As of `decide`.
    """
    poorer = tuple(one for c in result.final.candidates if c.at in names for one in _poorer_of(c, result, names))
    kept = drop_orphans([*(c for c in result.final.candidates if c.at not in names), *poorer])
    gone = {c.at for c in result.final.candidates} - {c.at for c in kept}
    away = {*names, *gone}
    named = tuple(f for f in result.findings if f.at not in away)
    only_named = replace(result, findings=named, deviations=counted_back(result.deviations, away))
    if not gone:
        return only_named
    begun = sizes_of_poorer(result.final.candidates, poorer, result.final.fit.values)
    near = FittedModel.at({**result.final.fit.values, **begun}) if begun else result.final
    final = _with_what_is_alike_as_one(result.fits.refined(result.fits.fit(kept, near)), result, names)
    anew = decide(result.name, result.model, result.fits, replace(result.search, final=final), split)
    replaced, instead = {c.at for c in kept} - final.named, final.named - {c.at for c in kept}
    kept_names = ({f.at for f in only_named.findings} | {c.at for c in poorer}) - replaced | instead
    if anew.has_unknown != result.has_unknown or {f.at for f in anew.findings} != kept_names:
        return only_named
    before = {f.at: f for f in result.findings}
    opened = tuple(open_to(f, before[f.at]) if f.at in before else f for f in anew.findings)
    return replace(anew, findings=opened, is_unresolved=result.is_unresolved, rejected=result.rejected)


def _with_what_is_alike_as_one(
    final: FittedModel, result: SubsystemResult[Model], names: Collection[tuple[str, str]]
) -> FittedModel:
    """Return a fit without some findings, a richer form replaced by the poorer one where the rest made alike what it tells apart.

    Two levels of friction that differed beside a dip are one without it.
    """
    fits, asked = result.fits, {one.effect: one for c in final.candidates for one in _poorer_of(c, result, names)}
    return in_poorer_forms(
        final, final.candidates, asked, result.model.constant_of_zeros, lambda those, near: fits.refined(fits.fit(those, near)),
        fits.deficit, fits.model.size,
    )  # fmt: skip


def _poorer_of(
    candidate: Candidate, result: SubsystemResult[Model], names: Collection[tuple[str, str]]
) -> tuple[Candidate, ...]:
    """Return the poorer form that takes the place of a candidate which is put aside, if there is one that is not put aside as well."""
    absorbed = poorer_than(candidate.effect)
    taken = {*names, *result.final.named}
    rivals = (rival for rival, _ in result.search.rivals.get(candidate.key, ()))
    return tuple(rival for rival in rivals if rival.effect in absorbed and rival.at not in taken)[:1]


def open_to(finding: Finding, before: Finding) -> Finding:
    """Return a finding whose intervals also carry what its numbers were beside the names that were put aside.

    These are put aside because they are less likely right than wrong, and may be right all the same: with p the most that such a name is
    probable, the mean square about a number that moved by d is its own and p d^2. Its own is no smaller than it was beside them: to leave
    a name out is not to know more.

    Args:
        finding: As found anew.
        before: The same beside those names.
    """

    def opened(name: str, one: Estimate) -> Estimate:
        old = before.parameters.get(name)
        if old is None:
            return one
        by = HALF_WIDTH * math.sqrt(LEAST_PROBABILITY) * abs(old.value - one.value)
        low = one.value - math.hypot(max(one.value - one.low, old.value - old.low), by)
        high = one.value + math.hypot(max(one.high - one.value, old.high - old.value), by)
        return replace(one, low=max(low, min(one.low, old.low, 0.0)), high=high)

    return replace(finding, parameters={name: opened(name, one) for name, one in finding.parameters.items()})
