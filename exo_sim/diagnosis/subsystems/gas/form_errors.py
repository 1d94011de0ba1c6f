"""What the form of the gas's equations leaves open of its nominal numbers, beside what noise does.

Heat, leaks, flow and the way a hose's volume lies along it are never quite of the machine's form, and a fit mends that with the numbers
that it may move: volumes first of all. However long a recording is, such a number is known no better.
"""

from __future__ import annotations

import math

from exo_sim.diagnosis.estimation.parameters import FreeParameter, PlantParameters, Target
from exo_sim.diagnosis.nominal_numbers import DEAD_VOLUME, FLOW_CAPACITY
from exo_sim.diagnosis.policy.off_nominal import AREA_FORM, HEAT_FORM, HOSE_AREA_FORM, HOSE_FORM, LAG_FORM, VOLUME_FORM
from exo_sim.physics.declaration import declared


def error_of_form(parameter: FreeParameter, fitted: PlantParameters, nominal: PlantParameters) -> float:
    """Return the standard error that the form of the equations leaves of a parameter, in its unit; 0 where it is not known to leave any.

    Args:
        parameter: The parameter.
        fitted: The plant as it was fitted.
        nominal: The plant as its owner describes it.
    """
    hoses = {one.name: one.identification.of_dead_volume for one in declared().values() if one.identification.of_dead_volume}
    volumes = {name: float(fitted.cylinder[name][of][0]) for name, of in hoses.items() if fitted.is_on(declared()[name])}
    if parameter.parameter == hoses.get(parameter.effect):
        return HOSE_FORM * volumes.get(parameter.effect, 0.0)
    if parameter.effect == FLOW_CAPACITY:
        return float(AREA_FORM)
    is_found = parameter.prior is None and parameter.effect in declared()  # what an owner's own law leaves open counts as the law's
    if is_found and parameter.effect in hoses and parameter.parameter == "area":
        return HOSE_AREA_FORM * float(fitted.cylinder[parameter.effect]["area"][0])
    if is_found and parameter.unit == "s" and parameter.target is Target.CYLINDER:
        return float(LAG_FORM)
    if is_found and parameter.unit == "W/K" and declared()[parameter.effect].identification.wall_heat:
        size = float(fitted.cylinder[parameter.effect][parameter.parameter][0])
        return size * math.hypot(HEAT_FORM, HOSE_FORM if any(volumes.values()) else 0.0)
    if parameter.effect != DEAD_VOLUME:
        return _in_twins(parameter, fitted)
    owner = nominal.cylinder[0]
    dead = float(owner[parameter.parameter])
    if dead <= 0.0:
        return 0.0
    middle = dead + 0.5 * float(owner[f"area_{parameter.parameter[-1]}"]) * float(owner["stroke"])
    return math.hypot(VOLUME_FORM * middle, HOSE_FORM * sum(volumes.values())) / dead


def _in_twins(parameter: FreeParameter, fitted: PlantParameters) -> float:
    """Return how much of a number's own action a fit wrote into the parts of its twin: so much of both is open.

    A shifted spool opens two edges sooner and two later. A fit shares that out by what either law does at full opening, which is of the
    form of a law: of a stranger's shift of 0.025 it wrote 0.0295 and -0.0045 in the edges, each known to 0.0015.
    """
    for effect in declared().values():
        for twin, parts in effect.identification.twins.as_parts.items():
            own = {effect.parameters[0].name: 1.0} if parameter.effect == effect.name else parts if parameter.effect == twin else {}
            if parameter.parameter in own and fitted.is_on(effect) and fitted.is_on(declared()[twin]):
                record = fitted.cylinder[twin]
                common = sum(share * float(record[name][0]) for name, share in parts.items()) / sum(share**2 for share in parts.values())
                return abs(own[parameter.parameter] * common)
    return 0.0
