"""Effects that are practically indistinguishable from a finding: they act as it does, and what they do besides would not show.

Play gives at its contacts, as a mount does, and opens where its load reverses: where the load never does, it is as good a name for the
mount. That is declared with the effect, and is no equivalence: the mount is no name for play. Other effects are another one in parts: a
spool that is shifted opens two edges sooner and two later, as edges of other overlaps do.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import Candidate, CandidateKey
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy.verdicts import AS_GOOD
from exo_sim.diagnosis.selection.cleared import Cleared
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel
from exo_sim.physics.declaration import identification_of

Array = NDArray[np.float64]


def indistinguishable_effects(
    model: LeastSquaresModel, final: FittedModel, candidates: Sequence[Candidate]
) -> dict[CandidateKey, list[tuple[Candidate, float]]]:
    """Return, by finding, the declared twins that would not show beside it, each with the log-likelihood that it costs at most.

    Args:
        model: The subsystem.
        final: The findings, with the Jacobian at their values.
        candidates: All candidates of the subsystem.
    """
    found: dict[CandidateKey, list[tuple[Candidate, float]]] = {}
    for finding in final.candidates:
        names = _twins_of(finding, final)
        for twin in candidates:
            if twin.effect in names and twin.where == finding.where and twin.at not in final.named:
                lost = max(_lost_by(model, final, twin, start) for start in twin.starts)
                if lost <= AS_GOOD:
                    found.setdefault(finding.key, []).append((twin, max(lost, 0.0)))
        for twin, lost in _as_parts(model, final, finding, candidates):
            if lost <= AS_GOOD:
                found.setdefault(finding.key, []).append((twin, max(lost, 0.0)))
    return found


def _as_parts(
    model: LeastSquaresModel, final: FittedModel, finding: Candidate, candidates: Sequence[Candidate]
) -> Iterator[tuple[Candidate, float]]:
    """Yield what a finding of one parameter is in parts, with what it costs in its place whatever else is free makes up for.

    Its parts come on top of what a healthy machine has of them, and a fit of it begins there. What comes on top of something that is not
    there is no name.
    """
    declared_parts = identification_of(finding.effect).twins.as_parts
    if not declared_parts or len(finding.parameters) != 1:
        return
    (whole,) = finding.parameters
    values = final.fit.values
    healthy = {q.slot: q for q in values}
    for twin in candidates:
        parts = declared_parts.get(twin.effect, {}) if twin.where == finding.where and twin.at not in final.named else {}
        own = {healthy.get(q.slot, q): parts[q.parameter] for q in twin.parameters if q.parameter in parts}
        if parts and len(own) == len(parts) and final.meets_prerequisite(twin):
            moved = {q: values.get(q, 0.0) + part * (values[whole] - whole.neutral) for q, part in own.items()}
            begun = tuple(moved.get(healthy.get(q.slot, q), values.get(healthy.get(q.slot, q), q.neutral)) for q in twin.parameters)
            lost = _lost(model, final, {**values, whole: whole.neutral, **moved}, final.fixed)
            yield replace(twin, starts=(begun, *twin.starts)), lost


def _twins_of(finding: Candidate, final: FittedModel) -> tuple[str, ...]:
    """Return the declared twins of a finding of this size."""
    twins = identification_of(finding.effect).twins
    sizes = {q.parameter: final.fit.values[q] for q in finding.parameters}
    return twins.unseen if all(sizes.get(name, least) >= least for name, least in twins.unseen_from.items()) else ()


def _lost_by(model: LeastSquaresModel, final: FittedModel, twin: Candidate, start: tuple[float, ...]) -> float:
    """Return the log-likelihood that a model loses by an effect of a given size whatever else is free makes up for."""
    values = {**final.fit.values, **dict(zip(twin.parameters, start, strict=True))}
    return _lost(model, final, values, [*final.fixed, *twin.fixed])


def _lost(
    model: LeastSquaresModel, final: FittedModel, values: dict[FreeParameter, float], fixed: Sequence[tuple[FreeParameter, float]]
) -> float:
    """Return the log-likelihood that a model loses with other values whatever is free makes up for."""
    fit = final.fit
    change = model.residual(values, fixed) - fit.residual
    if not np.isfinite(change).all():
        return math.inf
    beyond = Cleared.of(fit)
    clear = beyond.clear(change)
    more = float(clear @ clear + 2.0 * clear @ beyond.left)
    return 0.5 * more / max(correlation_time(fit.residual, model.blocks), 1.0)
