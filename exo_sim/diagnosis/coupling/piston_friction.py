"""Friction of a piston behind a transmission that gives: it decides where the piston is, and so how large the chambers are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.physics.declaration import family_of
from exo_sim.physics.transmission import gives

#: By cylinder, parameters of what resists its piston.
Friction = Mapping[str, Sequence[tuple[FreeParameter, float]]]


def is_soft(effect: str) -> bool:
    """True if an effect is of a transmission that gives."""
    return family_of(effect) == "transmission"


def softens(model: FittedModel) -> bool:
    """Return whether a model of the gas has a transmission that gives: then the forces are asked before the gas goes on."""
    return any(is_soft(candidate.effect) for candidate in model.candidates)


def friction_behind_soft_transmissions(gas: Sequence[SubsystemResult], motion: Sequence[SubsystemResult]) -> Friction:
    """Return what the balances of forces found to resist each piston whose transmission gives by the gas's own search."""
    soft = {one.where for one in gas if gives(one.plant_of(one.search.final).cylinder[0])}
    return {where: numbers for where, numbers in friction_of_pistons(motion).items() if where in soft}


def friction_of_pistons(motion: Sequence[SubsystemResult]) -> Friction:
    """Return what the balances of forces found to resist each piston, where they name something and nothing has no name."""
    found = {}
    for one in motion:
        if not one.has_unknown and any(c.kind is Kind.MISSING_PHYSICS for c in one.named):
            numbers = [*one.final.fit.values.items(), *one.final.fixed]
            found[one.where] = [(parameter, value) for parameter, value in numbers if parameter.target is Target.CYLINDER]
    return found
