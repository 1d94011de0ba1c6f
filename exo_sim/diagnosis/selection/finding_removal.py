"""Findings put aside: what is left of a result is fitted and decided once more, for its numbers were found beside them."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import drop_orphans
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.findings import Estimate, Finding
from exo_sim.diagnosis.policy.probability import LEAST_PROBABILITY
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel

Model = TypeVar("Model", bound=SubsystemModel)


def without_findings(
    result: SubsystemResult[Model], names: Collection[tuple[str, str]], split: Split | None = None
) -> SubsystemResult[Model]:
    """Return a result without some of its findings and what comes on top of them.

    Where the rest alone would leave something unknown, its numbers stay as they were found: only the names go.

    Args:
        result: A result.
        names: Effect and place of each.
        split: As of `decide`.
    """
    kept = drop_orphans([c for c in result.final.candidates if c.at not in names])
    gone = {c.at for c in result.final.candidates} - {c.at for c in kept}
    only_named = replace(result, findings=tuple(f for f in result.findings if (f.name, f.where) not in {*names, *gone}))
    if not gone:
        return only_named
    final = result.fits.refined(result.fits.fit(kept, result.final))
    anew = decide(result.name, result.model, result.fits, replace(result.search, final=final), split)
    kept_names = {(f.name, f.where) for f in only_named.findings}
    if anew.has_unknown != result.has_unknown or {(f.name, f.where) for f in anew.findings} != kept_names:
        return only_named
    before = {(f.name, f.where): f for f in result.findings}
    opened = tuple(open_to(f, before[f.name, f.where]) for f in anew.findings)
    return replace(anew, findings=opened, is_unresolved=result.is_unresolved, rejected=result.rejected)


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
