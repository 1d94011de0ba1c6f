"""Something is missing that no candidate explains: the finding of an unknown effect, and the curve that describes it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.policy.acceptance import LEAST_ODDS
from exo_sim.diagnosis.policy.probability import MAY_BE_NIL
from exo_sim.diagnosis.selection.final_residual import final_residual
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.effects.unknown import DEPENDS_ON
from exo_sim.physics.effects.unknown import EFFECT as UNKNOWN


@dataclass(frozen=True)
class UnknownEffect:
    """An unknown effect: its finding, what it stands for, the subsystem's result that it comes from, and whether its kind is told."""

    finding: Finding
    discrepancy: Discrepancy
    result: SubsystemResult[SubsystemModel]
    is_told_apart: bool = True


def unknown_effects(results: Sequence[SubsystemResult[SubsystemModel]]) -> tuple[UnknownEffect, ...]:
    """Return the unknown effect of every subsystem in which something is missing that no candidate explains."""
    return tuple(_unknown_effect(one) for one in results if one.has_unknown)


def effect_of(unknown: Sequence[UnknownEffect], result: SubsystemResult[SubsystemModel]) -> UnknownEffect | None:
    """Return the unknown effect of a subsystem's result, or None."""
    return next((effect for effect in unknown if effect.result.key == result.key), None)


def _unknown_effect(result: SubsystemResult[SubsystemModel]) -> UnknownEffect:
    model = result.model
    unnamed = result.search.unnamed
    plant, over = result.final_plant, [one.variable for one in unnamed]
    missing = model.discrepancy_over(plant, over) if unnamed else model.main_discrepancy(plant)
    best = missing.best
    variables = tuple(model.column(one.variable) for one in unnamed) or ((model.column(best.variable),) if best else ())
    n, fit = model.size, result.final.fit
    independent = n / max(result.fits.correlation_time(fit.residual), 1.0)
    says = f"Something without a name acts in the {missing.place} of {result.where}"
    says += f"; it follows {' and '.join(variables)}." if variables else "; it follows none of the recorded signals closely."
    told = not unnamed or _is_told_apart(missing, independent)
    if unnamed:
        says += " " + wording.varies(missing.acts, over, unnamed[0].share, told)
    says += " It comes in fast bursts, as a pressure that rings does." if missing.bursts else ""
    left = final_residual(result)
    says += " " + wording.rest(left.share, left.error, left.noise, left.unit)
    if variables:
        followed = best is not None and best.variable in DEPENDS_ON
        says += " " + wording.curve(variables[0], best.explains if best else None, followed, told)
    size = {"size": Estimate(missing.size, missing.unit, *(missing.size * share for share in spread_of_size(independent)))}
    odds = 0.5 * independent * np.log(max(fit.sse / n, 1.0)) / np.log(10.0)
    curve = _as_dict(missing, best) if best else None
    finding = Finding(UNKNOWN.name, result.where, Kind.UNKNOWN, says, size, float(odds), 0.0, depends_on=variables, curve=curve,
                      probability=unnamed[0].probability if unnamed else None)  # fmt: skip
    if size["size"].low <= 0.0:
        finding = replace(finding, probability=min(finding.confidence, float(MAY_BE_NIL)))
    return UnknownEffect(finding, missing, result, told)


def spread_of_size(independent: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a root mean square over so many independent values, as shares of it."""
    apart = HALF_WIDTH / math.sqrt(2.0 * max(independent, 1e-300))
    return max(0.0, 1.0 - apart), 1.0 + apart


def _is_told_apart(missing: Discrepancy, independent: float) -> bool:
    """Return whether the recordings tell a force from a friction: one follows its signal more closely than the other, by decisive odds.

    Args:
        missing: What is missing, as the one that does so more closely.
        independent: Number of independent rows.
    """
    if missing.otherwise is None:
        return False
    left, left_otherwise = (max(1.0 - share, 1e-12) for share in (missing.pattern, missing.otherwise))
    return 0.5 * independent * math.log10(left_otherwise / left) > LEAST_ODDS


def _as_dict(missing: Discrepancy, curve: Curve) -> dict[str, Any]:
    return {
        "acts": missing.acts, "variable": curve.variable, "at": [float(v) for v in curve.at], "unit": missing.unit,
        "values": [float(v) for v in curve.values], "band": [float(v) for v in curve.band], "explains": round(curve.explains, 3),
    }  # fmt: skip
