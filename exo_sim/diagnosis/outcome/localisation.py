"""Where the mismatch is, and what of it remains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exo_sim.diagnosis.discrepancy.trace import Trace
from exo_sim.diagnosis.findings import Located, Unexplained
from exo_sim.diagnosis.policy import recordings
from exo_sim.diagnosis.selection.final_residual import final_residual
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unknown_effect import UnknownEffect, effect_of
from exo_sim.diagnosis.subsystem_model import SubsystemModel


def located(results: Sequence[SubsystemResult[SubsystemModel]]) -> tuple[Located, ...]:
    """Return the balances in which the error above the noise is, the largest share first."""
    every = [trace for one in results for trace in one.model.traces(one.plant_of(one.search.baseline))]
    total = sum(trace.excess for trace in every)
    places: dict[tuple[str, str], list[Trace]] = {}
    for trace in every:
        places.setdefault((trace.where, trace.equation), []).append(trace)
    found = []
    for (where, equation), here in places.items():
        share = sum(trace.excess for trace in here) / total if total > 0.0 else 0.0
        if share < recordings.LISTED_SHARE:
            continue
        worst = max(here, key=lambda trace: trace.excess)
        good = worst.error[np.isfinite(worst.error)]
        found.append(
            Located(where, equation, share, worst.loud_spans(), worst.worst_regime(), float(np.sqrt(np.mean(good**2))), worst.noise,
                    worst.unit, worst.recording)
        )  # fmt: skip
    return tuple(sorted(found, key=lambda place: -place.share))


def unexplained(
    results: Sequence[SubsystemResult[SubsystemModel]], unknown: Sequence[UnknownEffect]
) -> tuple[Unexplained, ...]:
    """Return what the final models still miss: more than a trifle beside findings, and whatever is far above the noise."""
    found = []
    for one in results:
        if one.is_empty or one.is_unresolved:
            continue
        left = final_residual(one)
        beside = (one.named or one.has_unknown) and left.share > recordings.LISTED_REST
        if beside or left.times_noise > recordings.LOUD_REST:
            effect = effect_of(unknown, one)
            follows, curve = (effect.finding.depends_on, effect.discrepancy.best) if effect else ((), None)
            place, by_curve = f"{one.where}/{one.model.balance}", curve.explains if curve else 0.0
            found.append(Unexplained(place, follows, left.share, left.error, left.noise, left.unit, by_curve))
    return tuple(found)
