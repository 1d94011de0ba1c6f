"""How long a time step a valve bears: a longer one settles the chamber before the controller sees it."""

from __future__ import annotations

import math

from exo_sim.rig.schema import Cylinder, Rig


def longest_step(rig: Rig, cylinder: Cylinder) -> float:
    """Return half the time in which the open valve settles the chamber, the piston at mid-stroke [s] (B15's time constant)."""
    if cylinder.valve_area <= 0.0:
        return math.inf
    speed = math.sqrt(rig.heat_capacity_ratio * rig.specific_gas_constant * rig.supply.temperature)
    volume = cylinder.dead_volume_1 + 0.5 * cylinder.area_1 * cylinder.stroke
    return 0.5 * volume / (rig.heat_capacity_ratio * cylinder.valve_area * speed)
