"""Pressures and temperatures of chambers, supply and exhaust from the state, and the areas between them."""

from __future__ import annotations

from exo_sim.physics import chamber, cylinder, valve_areas
from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.conditions import Chamber, Reservoir
from exo_sim.physics.effects import (
    exhaust_back_pressure,
    line_restriction,
    supply_droop,
    supply_regulator,
    valve_characteristic,
    valve_edges,
    valve_null_leakage,
)
from exo_sim.physics.state import (
    ENERGY_1,
    ENERGY_2,
    EXHAUST_ENERGY,
    EXHAUST_MASS,
    HOSE_ENERGY_1,
    HOSE_ENERGY_2,
    HOSE_MASS_1,
    MASS_1,
    MASS_2,
    MIDDLE_MASS_1,
    SUPPLY_ENERGY,
    SUPPLY_MASS,
    TANK_ENERGY,
    TANK_MASS,
    WALL_1,
    WALL_2,
)

#: Least pressure that a volume is given, whatever was measured [Pa].
LOWEST = 1000.0

#: What is left of a chamber whose rig gives it no dead volume, the piston at its end [m^3].
SMALLEST = 1e-8


@inlined_kernel
def volumes(c, x: float) -> tuple[float, float]:
    """Return the volumes of both chambers [m^3] with the piston at x.

    Half of a hose of some length counts among them. A soft end stop lets the joint past the piston's end: the chamber then keeps half
    of its dead volume, or `SMALLEST`.
    """
    v_1 = cylinder.volume_1(x, c.area_1, c.dead_volume_1)
    v_2 = cylinder.volume_2(x, c.area_2, c.dead_volume_2, c.stroke)
    more = line_restriction.volume_at_chamber(c.line_restriction)
    return max(v_1, 0.5 * c.dead_volume_1, SMALLEST) + more, max(v_2, 0.5 * c.dead_volume_2, SMALLEST) + more


@inlined_kernel
def within(c, x: float) -> float:
    """Return the position nearest to x at which neither chamber is smaller than `volumes` lets it be [m]."""
    low = (max(0.5 * c.dead_volume_1, SMALLEST) - c.dead_volume_1) / c.area_1
    high = c.stroke - (max(0.5 * c.dead_volume_2, SMALLEST) - c.dead_volume_2) / c.area_2
    return min(max(x, low), high)


@inlined_kernel
def pressures(world, c, y, base: int, x: float) -> tuple[float, float]:
    """Return the absolute pressures of both chambers [Pa]; chamber 2 of a single-acting cylinder is the atmosphere."""
    v_1, v_2 = volumes(c, x)
    p_1 = chamber.pressure(y[base + ENERGY_1], v_1, world.k)
    if c.single_acting > 0.0:
        return p_1, world.atmosphere
    return p_1, chamber.pressure(y[base + ENERGY_2], v_2, world.k)


@inlined_kernel
def chambers(world, c, y, base: int, x: float, v: float):
    """Return both chambers of a cylinder whose piston is at x and moves at v, as two `Chamber`."""
    v_1, v_2 = volumes(c, x)
    k, r = world.k, world.r
    p_1 = chamber.pressure(y[base + ENERGY_1], v_1, k)
    t_1 = chamber.temperature(y[base + ENERGY_1], y[base + MASS_1], k, r)
    p_2, t_2 = world.atmosphere, world.ambient
    if c.single_acting == 0.0:
        p_2 = chamber.pressure(y[base + ENERGY_2], v_2, k)
        t_2 = chamber.temperature(y[base + ENERGY_2], y[base + MASS_2], k, r)
    one = Chamber(1, p_1, t_1, v_1, y[base + WALL_1], c.area_1, x, v, x, v, c.area_1, c.stroke)
    return one, Chamber(2, p_2, t_2, v_2, y[base + WALL_2], c.area_2, c.stroke - x, -v, x, v, c.area_1, c.stroke)


@kernel
def sensed_pressures(world, c, y, base: int, x: float) -> tuple[float, float]:
    """Return the absolute pressures where the sensors sit [Pa]: in the chambers, or at the valve's end of the hoses."""
    if line_restriction.present(c.line_restriction) and c.line_restriction.sensor > 0.0:
        hose = line_restriction.node_volume(c.line_restriction)
        p_1 = chamber.pressure(y[base + HOSE_ENERGY_1], hose, world.k)
        return p_1, chamber.pressure(
            y[base + HOSE_ENERGY_2], hose, world.k
        ) if c.single_acting == 0.0 else world.atmosphere
    return pressures(world, c, y, base, x)


@kernel
def temperatures(world, y, base: int) -> tuple[float, float]:
    """Return the gas temperatures of both chambers [K]."""
    t_1 = chamber.temperature(y[base + ENERGY_1], y[base + MASS_1], world.k, world.r)
    return t_1, chamber.temperature(y[base + ENERGY_2], y[base + MASS_2], world.k, world.r)


@inlined_kernel
def change_pressure(y, mass: int, volume: float, by: float, k: float) -> None:
    """Change the pressure of a volume [Pa] at its temperature; its energy stands behind its mass, at `mass`."""
    p = chamber.pressure(y[mass + 1], volume, k)
    factor = max(p + by, LOWEST) / p
    y[mass] *= factor
    y[mass + 1] *= factor


@inlined_kernel
def change_hose_pressure(c, y, base: int, side: int, by: float, k: float) -> None:
    """Change the pressure throughout the hose of chamber 1 or 2, side 0 or 1, if there is one [Pa]."""
    place, hose = base + 2 * side, c.line_restriction
    if line_restriction.present(hose):
        change_pressure(y, place + HOSE_MASS_1, line_restriction.node_volume(hose), by, k)
    if line_restriction.has_inertia(hose):
        change_pressure(y, place + MIDDLE_MASS_1, line_restriction.middle_volume(hose), by, k)


@inlined_kernel
def supply_state(world, y, shared: int, held: float):
    """Return the `Reservoir` upstream of every valve: an accumulator, what a regulator gives, or the rig's constants."""
    if supply_droop.present(world.supply_droop):
        p = chamber.pressure(y[shared + SUPPLY_ENERGY], world.supply_droop.volume, world.k)
        return Reservoir(p, chamber.temperature(y[shared + SUPPLY_ENERGY], y[shared + SUPPLY_MASS], world.k, world.r))
    p = supply_regulator.pressure(world.supply_regulator, world.supply_pressure, held)
    return Reservoir(p, world.supply_temperature)


@inlined_kernel
def exhaust_state(world, y, shared: int):
    """Return the `Reservoir` downstream of every valve: the manifold, or what the exhaust opens into."""
    if exhaust_back_pressure.present(world.exhaust_back_pressure):
        p = chamber.pressure(y[shared + EXHAUST_ENERGY], world.exhaust_back_pressure.volume, world.k)
        return Reservoir(p, chamber.temperature(y[shared + EXHAUST_ENERGY], y[shared + EXHAUST_MASS], world.k, world.r))
    return Reservoir(world.exhaust_pressure, world.ambient)


@kernel
def tank_state(world, y, shared: int):
    """Return the `Reservoir` of the recovery tank, which is mixed and without heat from its wall; ask where `tank_volume` is above zero."""
    p = chamber.pressure(y[shared + TANK_ENERGY], world.tank_volume, world.k)
    return Reservoir(p, chamber.temperature(y[shared + TANK_ENERGY], y[shared + TANK_MASS], world.k, world.r))


@inlined_kernel
def edges_are_told_apart(c) -> bool:
    """Return whether each edge of the valve has a way of its own to open: then it is given the place of the spool, not an opening."""
    return valve_edges.present(c.valve_edges) or valve_characteristic.present(c.valve_characteristic)


@inlined_kernel
def path_areas(c, opening_1: float, opening_2: float) -> tuple[float, float, float, float]:
    """Return the areas of supply->1, 1->exhaust, supply->2, 2->exhaust [m^2]; a vented cylinder has both exhausts open."""
    if c.vented == 0.0 and edges_are_told_apart(c):
        closed = valve_null_leakage.closed_area(c.valve_null_leakage)
        return valve_edges.path_areas(
            c.valve_edges, c.valve_characteristic, opening_1, opening_2, c.valve_deadband.width, c.valve_area, closed
        )
    return plain_path_areas(c, opening_1, opening_2)


@inlined_kernel
def plain_path_areas(c, opening_1: float, opening_2: float) -> tuple[float, float, float, float]:
    """Return the same for four edges that are alike."""
    if c.vented > 0.0:
        return 0.0, c.valve_area, 0.0, c.valve_area
    return valve_areas.path_areas(opening_1, opening_2, c.valve_area, valve_null_leakage.closed_area(c.valve_null_leakage))
