"""Gas that chambers give to a tank between exhaust and supply, and take from it again.

Each chamber has a path of its own to the tank, opened by a command from 0 to 1; which way the gas goes is for the pressures to say. The
tank is one volume, mixed, without heat from its wall: what it gets has cooled as it expanded, so that a wall would give it pressure.
"""

from __future__ import annotations

from exo_sim.physics import chamber, nozzle
from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.effects import line_restriction
from exo_sim.physics.nodes import chambers
from exo_sim.physics.settling import hot_gas, path_rate
from exo_sim.physics.state import (
    ENERGY_1,
    ENERGY_2,
    HOSE_ENERGY_1,
    HOSE_ENERGY_2,
    HOSE_MASS_1,
    HOSE_MASS_2,
    MASS_1,
    MASS_2,
    TANK_ENERGY,
    TANK_MASS,
)


@inlined_kernel
def exchange(world, c, y, dy, base, shared, here, opening, tank, mass, energy, hose_mass, hose_energy):
    """Add what flows from one chamber, or the valve's end of its hose, into the tank to the rates of both.

    Args:
        y, dy: Integrated state and its rate; the cylinder's part begins at `base`, the shared one at `shared`.
        here: The `Chamber`.
        opening: Of its path to the tank, relative, 0 to 1.
        tank: The `Reservoir` of the tank.
        mass, energy, hose_mass, hose_energy: Places of the chamber's and the hose's contents.
    """
    if opening <= 0.0 or c.tank_area <= 0.0:
        return
    k, r = world.k, world.r
    p, t = here.p, here.t
    if line_restriction.present(c.line_restriction):
        mass, energy = hose_mass, hose_energy
        p = chamber.pressure(y[base + energy], line_restriction.node_volume(c.line_restriction), k)
        t = chamber.temperature(y[base + energy], y[base + mass], k, r)
    w = nozzle.flow(min(opening, 1.0) * c.tank_area, p, t, tank.p, tank.t, k, r)
    h = chamber.enthalpy_flow(w, t, tank.t, k, r)
    dy[base + mass] -= w
    dy[base + energy] -= h
    dy[shared + TANK_MASS] += w
    dy[shared + TANK_ENERGY] += h


@inlined_kernel
def exchange_of_cylinder(world, c, y, dy, base, shared, x, v, opening_1, opening_2, tank):
    """Add what flows between both chambers of a cylinder and the tank to the rates; arguments as of `exchange`."""
    one, two = chambers(world, c, y, base, x, v)
    exchange(world, c, y, dy, base, shared, one, opening_1, tank, MASS_1, ENERGY_1, HOSE_MASS_1, HOSE_ENERGY_1)
    if c.single_acting == 0.0:
        exchange(world, c, y, dy, base, shared, two, opening_2, tank, MASS_2, ENERGY_2, HOSE_MASS_2, HOSE_ENERGY_2)


@inlined_kernel
def exchange_rate(world, c, here, opening, tank, span):
    """Return a bound on how fast a chamber, or its hose, settles through its path to the tank within `span` seconds [1/s]."""
    area = min(max(opening, 0.0), 1.0) * c.tank_area
    volume = line_restriction.node_volume(c.line_restriction) if line_restriction.present(c.line_restriction) else here.volume
    return path_rate(area, here.p, tank.p, volume, span, hot_gas(world.k, world.r)) * (1.0 + (volume / world.tank_volume) ** 0.5)
