"""Findings put aside: what is left of a result is fitted and decided once more, for its numbers were found beside them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

from exo_sim.diagnosis.estimation.candidate import drop_orphans
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel

Model = TypeVar("Model", bound=SubsystemModel)


def without_findings(result: SubsystemResult[Model], names: Collection[tuple[str, str]]) -> SubsystemResult[Model]:
    """Return a result without some of its findings and what comes on top of them.

    Where the rest alone would leave something unknown, its numbers stay as they were found: only the names go.

    Args:
        result: A result.
        names: Effect and place of each.
    """
    kept = drop_orphans([c for c in result.final.candidates if c.at not in names])
    gone = {c.at for c in result.final.candidates} - {c.at for c in kept}
    only_named = replace(result, findings=tuple(f for f in result.findings if (f.name, f.where) not in {*names, *gone}))
    if not gone:
        return only_named
    final = result.fits.refined(result.fits.fit(kept, result.final))
    anew = decide(result.name, result.model, result.fits, replace(result.search, final=final))
    told = {(f.name, f.where) for f in only_named.findings}
    if anew.has_unknown != result.has_unknown or {(f.name, f.where) for f in anew.findings} != told:
        return only_named
    return replace(anew, is_unresolved=result.is_unresolved, rejected=result.rejected)
