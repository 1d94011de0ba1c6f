"""The zero of a sensor that a fit moved: how surely, and whether further than a healthy one's is off."""

from __future__ import annotations

import math

from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.nominal_numbers import ZERO
from exo_sim.diagnosis.policy.acceptance import SURELY_MORE
from exo_sim.diagnosis.policy.healthy import ZEROS
from exo_sim.diagnosis.policy.priors import PRESSURE_ZERO
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.selection.unneeded_nuisances import error_of_model
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.effects import sensor_bias

Result = SubsystemResult[SubsystemModel]


def error_of(one: Result, parameter: FreeParameter, error: float) -> float:
    """Return the standard error of a refitted number, with what errors of the model do to a sensor's zero: they stand still as well."""
    return math.hypot(error, error_of_model(parameter, one.model.structural_error)) if parameter.effect == ZERO else error


def is_faulty(one: Result, parameter: FreeParameter, error: float) -> bool:
    """Return whether a sensor's zero is surely further off than a healthy one's; of what has something unknown in it nothing is sure.

    Args:
        one: The result that refitted it.
        parameter: Any refitted number.
        error: Its standard error by the fit.
    """
    if parameter.effect != ZERO or one.has_unknown or one.is_empty:
        return False
    return abs(one.final.fit.values[parameter]) - SURELY_MORE * error_of(one, parameter, error) > ZEROS * PRESSURE_ZERO


def zeros_within(one: Result) -> dict[str, float]:
    """Return how far off zeros can be at most by what a subsystem tells of them, to two digits [Pa]; by column, none where it is unsure.

    Errors of its model stand still as zeros do and are in it.
    """
    if _is_unsure(one):
        return {}
    end = one.search.final
    errors = {q: error_of(one, q, error) for q, error in one.fits.standard_errors(end).items() if q.effect == ZERO}
    return {q.where: float(f"{abs(end.fit.values[q]) + SURELY_MORE * error:.2g}") for q, error in errors.items()}


def zeros_of_forces_within(one: Result) -> dict[str, float]:
    """Return how far off zeros of what measures force can be at most by what a balance of forces tells of them [N or N m]; by column.

    A constant force that is missing, whether it was found or refitted, is such a zero. None where the balance is unsure.
    """
    if _is_unsure(one):
        return {}
    end, total, variance = one.search.final, dict[str, float](), dict[str, float]()
    for q, error in one.fits.standard_errors(end).items():
        at, beyond = (_zero_of_force(one.model, q, value) for value in (end.fit.values[q], end.fit.values[q] + error))
        if at is None or beyond is None:
            continue
        column, value = at
        total[column] = total.get(column, 0.0) + value
        variance[column] = variance.get(column, 0.0) + (beyond[1] - value) ** 2
    return {column: abs(value) + SURELY_MORE * math.sqrt(variance[column]) for column, value in total.items()}


def _zero_of_force(model: SubsystemModel, parameter: FreeParameter, value: float) -> tuple[str, float] | None:
    """Return the column that measures force, and its zero, which a number of a fit is; None where it is none."""
    if parameter.effect == sensor_bias.EFFECT.name:
        column, zero = parameter.where, value
    else:
        stands_for = model.as_sensor_error(parameter, value)
        if stands_for is None or stands_for[1] != sensor_bias.EFFECT.name:
            return None
        column, zero = stands_for[0], stands_for[3]
    return None if "pressure" in column else (column, zero)


def _is_unsure(one: Result) -> bool:
    """Return whether nothing that a result refitted tells how far off a zero can be."""
    return one.has_unknown or one.is_empty or one.search.interrupted
