"""The balances of mass and energy: what every volume gains and loses in a second.

The same lines are compiled twice: as they stand, and for a cylinder to whose gas nothing is added, without what is then zero.
"""

from __future__ import annotations

from exo_sim.physics import chamber, nozzle
from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.conditions import Reservoir
from exo_sim.physics.effects import (
    critical_ratio,
    end_cushioning,
    exhaust_back_pressure,
    heat_transfer_law,
    line_restriction,
    moving_wall_temperature,
    supply_droop,
    supply_regulator,
)
from exo_sim.physics.gas_effects_off import plain
from exo_sim.physics.nodes import chambers, exhaust_state, path_areas, plain_path_areas, supply_state, tank_state
from exo_sim.physics.recovery_tank import exchange_of_cylinder
from exo_sim.physics.state import (
    DRAWN,
    DRAWN_ENTHALPY,
    ENERGY_1,
    ENERGY_2,
    EXHAUST_ENERGY,
    EXHAUST_MASS,
    EXHAUSTED,
    EXHAUSTED_ENTHALPY,
    FED,
    FED_ENTHALPY,
    HEAT,
    HOSE_ENERGY_1,
    HOSE_FLOW_1,
    HOSE_MASS_1,
    INTEGRATED,
    LEAKED,
    LEAKED_ENTHALPY,
    MASS_1,
    MASS_2,
    MIDDLE_ENERGY_1,
    MIDDLE_FLOW_1,
    MIDDLE_MASS_1,
    RELEASED,
    RELEASED_ENTHALPY,
    SHARED,
    SUPPLY_ENERGY,
    SUPPLY_MASS,
    WALL_1,
    WALL_2,
    WORK,
)
from exo_sim.physics.summed_effects import across_flow, heat_flow, outward_flow
from exo_sim.physics.terms import Function, within


@within
def _lose(here, w, ambient, k, r, dy, base, mass, energy):
    """Take a flow to the surroundings [kg/s] from a chamber and enter it in the books."""
    if w == 0.0:
        return
    h = chamber.enthalpy_flow(w, here.t, ambient, k, r)
    dy[base + mass] -= w
    dy[base + energy] -= h
    dy[base + LEAKED] += w
    dy[base + LEAKED_ENTHALPY] += h


@within
def _warm_and_push(world, c, here, filling, dy, base, energy, wall):
    """Give a chamber, into which gas flows at this rate [kg/s], the heat from its wall and take from it the work on the piston."""
    heat = heat_flow(c, here, world) * heat_transfer_law.factor(c.heat_transfer_law, here, filling, world.r)
    work = here.p * here.area * here.speed
    dy[base + wall] = moving_wall_temperature.wall_rate(c.moving_wall_temperature, heat, here.wall, world.ambient)
    dy[base + energy] += heat
    dy[base + energy] -= work
    dy[base + HEAT] += heat
    dy[base + WORK] += work


@within
def _warm_hose(world, p, here, y, dy, base, energy, second):
    """Give the gas in a chamber's hose the heat from the hose's wall; the part of it that is filled with the chamber has its gas.

    Args:
        p: The hose.
        here: The `Chamber`.
        y, dy: Integrated state and its rate.
        energy: Place of the chamber's energy, counted from `base`.
        second: 1 for the hose of chamber 2.
    """
    if not p.conductance > 0.0:
        return
    k, r, ambient = world.k, world.r, world.ambient
    place = base + 2 * second
    t_port = chamber.temperature(y[place + HOSE_ENERGY_1], y[place + HOSE_MASS_1], k, r)
    heat = line_restriction.warming(p, line_restriction.node_volume(p), t_port, ambient)
    dy[place + HOSE_ENERGY_1] += heat
    if line_restriction.has_inertia(p):
        t_middle = chamber.temperature(y[place + MIDDLE_ENERGY_1], y[place + MIDDLE_MASS_1], k, r)
        middle = line_restriction.warming(p, line_restriction.middle_volume(p), t_middle, ambient)
        inner = line_restriction.warming(p, line_restriction.volume_at_chamber(p), here.t, ambient)
        dy[place + MIDDLE_ENERGY_1] += middle
        dy[base + energy] += inner
        heat += middle + inner
    dy[base + HEAT] += heat


@within
def through_middle(p, outlet, port, here, k, r, y, dy, side):
    """Write the rates of the middle of a long hose and of the flows in its halves; return both flows with their enthalpies.

    Args:
        p: The hose.
        outlet: Area that a cushion leaves gas on its way out of the chamber.
        port, here: Gas at the valve's end, and the `Chamber`.
        y, dy: Integrated state and its rate; the side's places are counted from `side`.
    """
    mass, energy = side + MIDDLE_MASS_1, side + MIDDLE_ENERGY_1
    p_middle = chamber.pressure(y[energy], line_restriction.middle_volume(p), k)
    t_middle = chamber.temperature(y[energy], y[mass], k, r)
    first, second = y[side + HOSE_FLOW_1], y[side + MIDDLE_FLOW_1]
    whole, at_chamber = line_restriction.resistances(p, outlet if second < 0.0 else p.area, port.p, port.t, here.p, here.t, k, r)
    dy[side + HOSE_FLOW_1] = line_restriction.acceleration(p, whole, first, port.p, port.t, p_middle, t_middle, r)
    dy[side + MIDDLE_FLOW_1] = line_restriction.acceleration(p, at_chamber, second, p_middle, t_middle, here.p, here.t, r)
    h_first = chamber.enthalpy_flow(first, port.t, t_middle, k, r)
    h_second = chamber.enthalpy_flow(second, t_middle, here.t, k, r)
    dy[mass], dy[energy] = first - second, h_first - h_second
    return first, h_first, second, h_second


def _through_valve(added: bool) -> Function:
    """Return the kernel of what a valve does to one chamber, with or without what may stand between them."""

    @within
    def directly(c, here, a_supply, a_exhaust, supply, exhaust, k, r):
        if added:
            drawn = critical_ratio.flow(c.critical_ratio, a_supply, supply.p, supply.t, here.p, here.t, k, r)
            vented = critical_ratio.flow(c.critical_ratio, a_exhaust, here.p, here.t, exhaust.p, exhaust.t, k, r)
        else:
            drawn = nozzle.flow(a_supply, supply.p, supply.t, here.p, here.t, k, r)
            vented = nozzle.flow(a_exhaust, here.p, here.t, exhaust.p, exhaust.t, k, r)
        h_drawn = chamber.enthalpy_flow(drawn, supply.t, here.t, k, r)
        return drawn, h_drawn, vented, chamber.enthalpy_flow(vented, here.t, exhaust.t, k, r)

    @within
    def flows(c, here, a_supply, a_exhaust, supply, exhaust, k, r, y, dy, base, second):
        """Return mass and enthalpy flow into the chamber, and those drawn from the supply and let into the exhaust."""
        if not added or not line_restriction.present(c.line_restriction):
            if added and here.p > exhaust.p:
                a_exhaust = end_cushioning.outlet(c.end_cushioning, a_exhaust, here.depth)
            if added and here.p > supply.p:
                a_supply = end_cushioning.outlet(c.end_cushioning, a_supply, here.depth)
            drawn, h_drawn, vented, h_vented = directly(c, here, a_supply, a_exhaust, supply, exhaust, k, r)
            return drawn - vented, h_drawn - h_vented, drawn, h_drawn, vented, h_vented
        hose_mass, hose_energy = base + HOSE_MASS_1 + 2 * second, base + HOSE_ENERGY_1 + 2 * second
        p_port = chamber.pressure(y[hose_energy], line_restriction.node_volume(c.line_restriction), k)
        port = Reservoir(p_port, chamber.temperature(y[hose_energy], y[hose_mass], k, r))
        drawn, h_drawn, vented, h_vented = directly(c, port, a_supply, a_exhaust, supply, exhaust, k, r)
        area = c.line_restriction.area
        outlet = end_cushioning.outlet(c.end_cushioning, area, here.depth)
        if line_restriction.has_inertia(c.line_restriction):
            into, h_into, w, h = through_middle(c.line_restriction, outlet, port, here, k, r, y, dy, base + 2 * second)
        else:
            area = outlet if here.p > port.p else area
            w = line_restriction.flow(c.line_restriction, area, port.p, port.t, here.p, here.t, k, r)
            h = chamber.enthalpy_flow(w, port.t, here.t, k, r)
            into, h_into = w, h
        dy[hose_mass] = drawn - vented - into
        dy[hose_energy] = h_drawn - h_vented - h_into
        return w, h, drawn, h_drawn, vented, h_vented

    return flows


def _of_cylinder(added: bool) -> Function:
    """Return the kernel of one cylinder's rates, with or without what effects add."""
    through_valve = _through_valve(added)
    areas = path_areas if added else plain_path_areas

    @within
    def rates_of(world, c, y, dy, base, x, v, opening_1, opening_2, supply, exhaust):
        for j in range(INTEGRATED):
            dy[base + j] = 0.0
        k, r, ambient = world.k, world.r, world.ambient
        one, two = chambers(world, c, y, base, x, v)
        a_s1, a_1e, a_s2, a_2e = areas(c, opening_1, opening_2)
        w, h, drawn, h_drawn, vented, h_vented = through_valve(
            c, one, a_s1, a_1e, supply, exhaust, k, r, y, dy, base, 0
        )
        dy[base + MASS_1] = w
        dy[base + ENERGY_1] = h
        across = 0.0
        if added:
            _lose(one, outward_flow(c, one, two, world), ambient, k, r, dy, base, MASS_1, ENERGY_1)
            _warm_and_push(world, c, one, w, dy, base, ENERGY_1, WALL_1)
            if line_restriction.present(c.line_restriction):
                _warm_hose(world, c.line_restriction, one, y, dy, base, ENERGY_1, 0)
            across = across_flow(c, one, two, world)
            if c.single_acting > 0.0:
                _lose(one, across, ambient, k, r, dy, base, MASS_1, ENERGY_1)
        else:
            dy[base + ENERGY_1] -= one.p * one.area * one.speed
        if not added or c.single_acting == 0.0:
            w, h, drawn_2, h_drawn_2, vented_2, h_vented_2 = through_valve(
                c, two, a_s2, a_2e, supply, exhaust, k, r, y, dy, base, 1
            )
            drawn, h_drawn, vented, h_vented = drawn + drawn_2, h_drawn + h_drawn_2, vented + vented_2, h_vented + h_vented_2
            dy[base + MASS_2] = w
            dy[base + ENERGY_2] = h
            if added:
                _lose(two, outward_flow(c, two, one, world), ambient, k, r, dy, base, MASS_2, ENERGY_2)
                h_across = chamber.enthalpy_flow(across, one.t, two.t, k, r)
                dy[base + MASS_1] -= across
                dy[base + ENERGY_1] -= h_across
                dy[base + MASS_2] += across
                dy[base + ENERGY_2] += h_across
                _warm_and_push(world, c, two, w, dy, base, ENERGY_2, WALL_2)
                if line_restriction.present(c.line_restriction):
                    _warm_hose(world, c.line_restriction, two, y, dy, base, ENERGY_2, 1)
            else:
                dy[base + ENERGY_2] -= two.p * two.area * two.speed
                dy[base + WORK] = one.p * one.area * one.speed + two.p * two.area * two.speed
        dy[base + DRAWN] = drawn
        dy[base + DRAWN_ENTHALPY] = h_drawn
        dy[base + EXHAUSTED] = vented
        dy[base + EXHAUSTED_ENTHALPY] = h_vented
        return drawn, h_drawn, vented, h_vented

    return rates_of


_rates_with_effects, _rates_of_plain_cylinder = _of_cylinder(True), _of_cylinder(False)


@inlined_kernel
def cylinder_rates(world, c, y, dy, base, x, v, opening_1, opening_2, supply, exhaust):
    """Write d/dt of one cylinder's integrated state; return its flows from the supply and into the exhaust, with enthalpies.

    Args:
        y, dy: Integrated state and its rate; the cylinder's part begins at `base`.
        x, v: Position and speed of the piston.
        opening_1, opening_2: Relative openings towards each chamber, dead-band and offset already applied.
        supply, exhaust: `Reservoir` upstream and downstream of the valve.
    """
    if plain(c):
        return _rates_of_plain_cylinder(world, c, y, dy, base, x, v, opening_1, opening_2, supply, exhaust)
    return _rates_with_effects(world, c, y, dy, base, x, v, opening_1, opening_2, supply, exhaust)


@inlined_kernel
def rates(world, cylinders, y, dy, held, x, v, spool):
    """Write d/dt of the integrated state; return the mass flow drawn from the supply [kg/s].

    Args:
        y, dy: Integrated state and its rate, shape (integrated_size,).
        held: The flow that the regulator's diaphragm holds [kg/s].
        x, v: Piston positions and speeds, shape (n,).
        spool: Relative openings, dead-band and offset already applied: towards chambers 1, then towards chambers 2, shape (2 n,);
            with a recovery tank then those of the paths between chambers 1, then chambers 2, and the tank, shape (4 n,).
    """
    n = len(cylinders)
    shared = n * INTEGRATED
    supply, exhaust = supply_state(world, y, shared, held), exhaust_state(world, y, shared)
    drawn = h_drawn = vented = h_vented = 0.0
    for i in range(n):
        w, h, e, he = cylinder_rates(world, cylinders[i], y, dy, i * INTEGRATED, x[i], v[i], spool[i], spool[n + i], supply, exhaust)
        drawn += w
        h_drawn += h
        vented += e
        h_vented += he
    for j in range(SHARED):
        dy[shared + j] = 0.0
    k, r = world.k, world.r
    if world.tank_volume > 0.0:
        tank = tank_state(world, y, shared)
        for i in range(n):
            openings = spool[2 * n + i], spool[3 * n + i]
            exchange_of_cylinder(world, cylinders[i], y, dy, i * INTEGRATED, shared, x[i], v[i], openings[0], openings[1], tank)
    if supply_droop.present(world.supply_droop):
        p_source = supply_regulator.pressure(world.supply_regulator, world.supply_pressure, held)
        fed = supply_droop.feed(world.supply_droop, p_source, supply.p)
        dy[shared + FED] = fed
        dy[shared + FED_ENTHALPY] = chamber.enthalpy_flow(fed, world.supply_temperature, supply.t, k, r)
        dy[shared + SUPPLY_MASS] = fed - drawn
        dy[shared + SUPPLY_ENERGY] = dy[shared + FED_ENTHALPY] - h_drawn
        drawn = fed
    if exhaust_back_pressure.present(world.exhaust_back_pressure):
        out = exhaust_back_pressure.flow(
            world.exhaust_back_pressure, exhaust.p, exhaust.t, world.exhaust_pressure, world.ambient, k, r
        )
        dy[shared + RELEASED] = out
        dy[shared + RELEASED_ENTHALPY] = chamber.enthalpy_flow(out, exhaust.t, world.ambient, k, r)
        dy[shared + EXHAUST_MASS] = vented - out
        dy[shared + EXHAUST_ENERGY] = h_vented - dy[shared + RELEASED_ENTHALPY]
    return drawn
