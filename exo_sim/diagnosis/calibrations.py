"""Believed numbers that a fit found to be off: which of them are worth telling, which are only refitted, and how they are told."""

from __future__ import annotations

import math
from collections.abc import Sequence

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.fitted_set import Problem, Trial
from exo_sim.diagnosis.gas_problem import GasProblem
from exo_sim.diagnosis.intervals import bounds, ends
from exo_sim.diagnosis.quantity import Quantity
from exo_sim.diagnosis.result import Estimate, Finding
from exo_sim.physics.effects.declaration import declared

#: No equation describes a machine, nor a sensor its pressure, to better than this share (one standard deviation).
MODEL_SHARE = 0.0015
#: A believed number is corrected where it is off by this many standard errors, and by this share.
SURE, WORTH = 3.0, {"flow_capacity": 0.01, "dead_volume": 0.03, "payload_mass": 0.005, "joint_damping": 0.15}
#: ... and a number of an effect that the rig has on already, by this one.
WORTH_OF_EFFECT = 0.1
#: A number that a fit moved by less than this share was not touched.
TOUCHED = 1e-3


def unseen(problem: Problem, quantity: Quantity) -> bool:
    """Say whether a number is of a chamber whose pressure nobody recorded: it takes in whatever else is unknown there."""
    if quantity.effect != "dead_volume" or not isinstance(problem, GasProblem):
        return False
    side = int(quantity.parameter[-1]) - 1
    return all(run.pressure[side] is None for run in problem.runs)


def calibrated(trial: Trial, spread: dict[Quantity, float]) -> list[tuple[Quantity, float, float]]:
    """Return believed numbers that are off: quantity, factor, its standard error."""
    found, asked = [], trial.asked
    for quantity, value in trial.fit.values.items():
        whole = quantity.prior[0] if quantity.prior and quantity.effect in declared() else 1.0
        if whole == 0.0 or (quantity.effect not in WORTH and quantity.effect not in declared()) or quantity in asked:
            continue
        factor, error = value / whole, spread.get(quantity, math.inf) / abs(whole)
        if abs(factor - 1.0) > max(SURE * error, WORTH.get(quantity.effect, WORTH_OF_EFFECT)):
            found.append((quantity, factor, error))
    return found


def refitted_besides(
    trial: Trial, spread: dict[Quantity, float], told: set[Quantity], named: bool
) -> tuple[tuple[Quantity, float], ...]:
    """Return believed numbers that the improved rig should hold as fitted, and that are no finding: quantity and its standard error.

    Those that are surely off; and where something was `named`, all that the rig holds, for what was found was fitted with them.
    """
    found, asked = [], trial.asked
    for quantity, value in trial.fit.values.items():
        error = spread.get(quantity, math.inf)
        if not quantity.prior or quantity in told or quantity in asked or not math.isfinite(error):
            continue
        believed = quantity.prior[0]
        beside = named and believed != 0.0 and abs(value - believed) > TOUCHED * abs(believed)
        if beside or abs(value - believed) > SURE * error:
            found.append((quantity, error))
    return tuple(found)


def calibration_findings(numbers: Sequence[tuple[Quantity, float, float]]) -> list[Finding]:
    """Return a finding for every believed number that is off; the two dead volumes of a cylinder are one.

    Args:
        numbers: Quantity, factor, its standard error.
    """
    kinds: dict[tuple[str, str], list[tuple[Quantity, float, float]]] = {}
    for quantity, factor, error in numbers:
        kinds.setdefault((quantity.effect, quantity.where), []).append((quantity, factor, error))
    return [_calibration(name, where, parts) for (name, where), parts in kinds.items()]


def _calibration(name: str, where: str, parts: Sequence[tuple[Quantity, float, float]]) -> Finding:
    weights = [1.0 / max(error, 1e-9) ** 2 for _, _, error in parts]
    mean = sum(w * factor for w, (_, factor, _) in zip(weights, parts, strict=True)) / sum(weights)
    apart = max(abs(factor - mean) for _, factor, _ in parts)
    spread = max(math.sqrt(1.0 / sum(weights)), apart, MODEL_SHARE)
    low, high = ends(mean, spread) if known(name) else bounds(parts[0][0], mean, spread)
    parameters = {"factor": Estimate(mean, "1", low, high)}
    if name == "dead_volume":
        for quantity, factor, error in parts:
            parameters[quantity.parameter] = Estimate(factor, "1", *bounds(quantity, factor, max(error, MODEL_SHARE)))
    if known(name):
        parameters = {
            q.parameter: Estimate(factor * q.prior[0], q.unit, *sorted(q.prior[0] * end for end in ends(factor, max(error, MODEL_SHARE))))
            for q, factor, error in parts
            if q.prior
        }
    odds = sum(((factor - 1.0) / max(error, 1e-12)) ** 2 for _, factor, error in parts) / (2.0 * math.log(10.0))
    says = " ".join(wording.calibration(name, quantity.parameter, factor) for quantity, factor, _ in parts)
    return Finding(name, where, "calibration", says, parameters, odds, 0.0)


def known(effect: str) -> bool:
    """Say whether a name is one of the declared effects."""
    return effect in declared()
