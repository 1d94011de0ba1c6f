"""Errors of a sensor as candidates."""

from __future__ import annotations

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Kind
from exo_sim.physics.declaration import Effect


def sensor_error(
    effect: Effect, column: str, name: str, unit: str, scale: float, bounds: tuple[float, float], limit: float, neutral: float = 0.0
) -> Candidate:
    """Return the candidate of one error of one sensor.

    Args:
        effect: What is declared of it; it has one parameter.
        column: The column that it writes.
        name: What the model of the subsystem calls the number, e.g. `"pressure_1.bias"`.
        unit: Its SI unit.
        scale: Typical size, from `neutral`.
        bounds: Least and most.
        limit: Distance from `neutral` up to which a healthy sensor shows it as well.
        neutral: Value of a perfect sensor.
    """
    free = FreeParameter(effect.name, column, name, unit, Target.SENSOR, scale, *bounds, neutral=neutral, healthy_limit=limit)
    return Candidate(effect.name, column, effect.parameters[0].name, (free,), ((neutral + scale,),), kind=Kind.SENSOR)
