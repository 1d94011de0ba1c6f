"""The zero of a load cell, as the balance of the load shows it that it moves, for the balance along its rod.

Along a rod a cell that is off cannot be told from friction that differs by direction; the mass behind the cell tells them apart.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystems.motion.candidates import candidates
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.physics.effects import sensor_bias

#: Zero of a load cell and its standard error [N].
Zero = tuple[float, float]


def cell_zeros(balances: Sequence[SubsystemResult[MotionModel]]) -> Mapping[str, Zero]:
    """Return the zeros of load cells by column, as far as balances of what they move show them.

    Args:
        balances: Judged balances of forces; those with something unknown in them say nothing.
    """
    found: dict[str, Zero] = {}
    for one in balances:
        if one.is_empty or one.has_unknown or one.search.interrupted or not one.model.runs[0].inertia.has_mass:
            continue
        for column in (column for column in one.model.runs[0].drive.signals if column.endswith(".force")):
            zero = _zero_in(one, column)
            if zero is not None and (column not in found or zero[1] < found[column][1]):
                found[column] = zero
    return found


def zero_along(runs: Sequence[MotionRun], zeros: Mapping[str, Zero]) -> Zero | None:
    """Return the zero of the cell of a rod's balance; None where it has none, or nothing showed it."""
    run = runs[0]
    return zeros.get(f"{run.cylinder}.force") if not run.inertia.has_mass else None


def _zero_in(one: SubsystemResult[MotionModel], column: str) -> Zero | None:
    """Return the zero of a cell that is fitted beside everything that a balance names, None where it cannot be."""
    model, final = one.model, one.final
    asked = candidates(model.runs, model.nominal, model.where)
    zero = next((c for c in asked if (c.effect, c.where) == (sensor_bias.EFFECT.name, column)), None)
    if zero is None:
        return None
    if zero.at not in final.named:
        final = one.fits.fit((*final.candidates, zero), final)
    parameter = zero.parameters[0]
    error = max(one.fits.standard_errors(final).get(parameter, math.inf), one.search.errors.get(parameter, 0.0))
    value = final.fit.values[parameter]
    return (value, error) if math.isfinite(value) and math.isfinite(error) else None
