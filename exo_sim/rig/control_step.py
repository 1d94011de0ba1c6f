"""How long a time step a valve bears: a longer one settles the chamber before the controller sees it."""

from __future__ import annotations

import math

from exo_sim.errors import ModelError
from exo_sim.rig.schema import Cylinder, Rig


def longest_step(rig: Rig, cylinder: Cylinder) -> float:
    """Return half the time in which the open valve settles the chamber, the piston at mid-stroke [s] (B15's time constant)."""
    if cylinder.valve_area <= 0.0:
        return math.inf
    speed = math.sqrt(rig.heat_capacity_ratio * rig.specific_gas_constant * rig.supply.temperature)
    volume = cylinder.dead_volume_1 + 0.5 * cylinder.area_1 * cylinder.stroke
    return 0.5 * volume / (rig.heat_capacity_ratio * cylinder.valve_area * speed)


def check_step(rig: Rig, step: float) -> None:
    """Refuse a time step [s] in which an open valve would all but settle a chamber: no held command steers a force then.

    Raises:
        ModelError: the step is more than half the time in which a chamber settles, the piston at mid-stroke.
    """
    for cylinder in rig.cylinders.values():
        longest = longest_step(rig, cylinder)
        if step > longest:
            raise ModelError(
                f"{rig.model}: timestep = {step:g} s is too long for the valve of cylinder {cylinder.name}, which fills half "
                f"the cylinder in {2e3 * longest:.1f} ms; write at most {0.95 * longest:.1g}"
            )
