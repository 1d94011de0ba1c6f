"""What happens in one step of the pneumatics, in which order: the place that calls every effect.

A plant is any number of cylinders on one supply and one exhaust. Its state is one vector (`state.py`), its numbers are records
(`records.py`). With every effect off this is the paper: two chambers with their own mass and energy, four metering edges.
"""

from __future__ import annotations

import math

from exo_sim.physics import chamber, gas
from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects import (
    critical_ratio,
    end_cushioning,
    exhaust_back_pressure,
    external_leakage,
    line_restriction,
    moving_wall_temperature,
    piston_leakage,
    spool_rate_limit,
    supply_droop,
    supply_regulator,
    unknown,
    valve_deadband,
    valve_hysteresis,
    valve_lag,
    valve_offset,
    wall_heat_transfer,
)
from exo_sim.physics.integrator import COEFFICIENTS
from exo_sim.physics.nodes import (
    exhaust_state,
    path_areas,
    pressures,
    sensed_pressures,
    supply_state,
    temperatures,
    volumes,
    within,
)
from exo_sim.physics.pace import MOST_STEPS, step_length
from exo_sim.physics.plain import plain, plain_rates
from exo_sim.physics.resistance import dry_level, move_bristle
from exo_sim.physics.state import (
    BRISTLE,
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
    FELT,
    HEAT,
    HELD,
    HOSE_ENERGY_1,
    HOSE_ENERGY_2,
    HOSE_MASS_1,
    HOSE_MASS_2,
    INTEGRATED,
    LEAKED,
    LEAKED_ENTHALPY,
    MASS_1,
    MASS_2,
    PISTON,
    PISTON_SPEED,
    PLAY,
    RELEASED,
    RELEASED_ENTHALPY,
    REMEMBERED,
    SHARED,
    SPOOL,
    SUPPLY_ENERGY,
    SUPPLY_MASS,
    WALL_1,
    WALL_2,
    WORK,
)
from exo_sim.physics.transmission import gives, piston_at

__all__ = [
    "advance",
    "cylinder_rates",
    "integrate",
    "pressures",
    "rates",
    "sensed_pressures",
    "temperatures",
    "volumes",
]


@kernel
def side_rates(world, c, p, t, from_end, a_supply, a_exhaust, p_s, t_s, p_e, t_e, y, dy, base, hose_m, hose_u):
    """Write what the valve does to one chamber; return mass flow and enthalpy flow into that chamber, and into the exhaust.

    The flow passes the hose's node where there is one, else it goes straight into the chamber.
    """
    k, r = world.k, world.r
    cp = k * r / (k - 1.0)
    hose = line_restriction.present(c.line_restriction)
    if hose:
        p_port = chamber.pressure(y[base + hose_u], c.line_restriction.volume, k)
        t_port = chamber.temperature(y[base + hose_u], y[base + hose_m], k, r)
    else:
        p_port, t_port = p, t
        if p > p_e:
            a_exhaust = end_cushioning.outlet(c.end_cushioning, a_exhaust, from_end)
        if p > p_s:
            a_supply = end_cushioning.outlet(c.end_cushioning, a_supply, from_end)
    drawn = critical_ratio.flow(c.critical_ratio, a_supply, p_s, t_s, p_port, t_port, k, r)
    vented = critical_ratio.flow(c.critical_ratio, a_exhaust, p_port, t_port, p_e, t_e, k, r)
    h_drawn = drawn * cp * (t_s if drawn > 0.0 else t_port)
    h_vented = vented * cp * (t_port if vented > 0.0 else t_e)
    dy[base + DRAWN] += drawn
    dy[base + DRAWN_ENTHALPY] += h_drawn
    dy[base + EXHAUSTED] += vented
    dy[base + EXHAUSTED_ENTHALPY] += h_vented
    if not hose:
        return drawn - vented, h_drawn - h_vented, vented, h_vented
    area = c.line_restriction.area
    if p > p_port:
        area = end_cushioning.outlet(c.end_cushioning, area, from_end)
    w = gas.flow(area, p_port, t_port, p, t, k, r)
    h = w * cp * (t_port if w > 0.0 else t)
    dy[base + hose_m] = drawn - vented - w
    dy[base + hose_u] = h_drawn - h_vented - h
    return w, h, vented, h_vented


@kernel
def stray(world, dy, base: int, mass: int, energy: int, t_gas: float, w: float):
    """Add a flow from the surroundings into one chamber [kg/s] to its rates, as a leak with the sign turned."""
    h = w * world.k * world.r / (world.k - 1.0) * (world.ambient if w > 0.0 else t_gas)
    dy[base + mass] += w
    dy[base + energy] += h
    dy[base + LEAKED] -= w
    dy[base + LEAKED_ENTHALPY] -= h


@kernel
def cylinder_rates(world, c, y, dy, base, x, v, opening, p_s, t_s, p_e, t_e):
    """Write d/dt of one cylinder's integrated state; return its flows from the supply and into the exhaust, with enthalpies."""
    if plain(c):
        return plain_rates(world, c, y, dy, base, x, v, opening, p_s, t_s, p_e, t_e)
    for j in range(INTEGRATED):
        dy[base + j] = 0.0
    k, r = world.k, world.r
    cp = k * r / (k - 1.0)
    p_1, p_2 = pressures(world, c, y, base, x)
    t_1 = chamber.temperature(y[base + ENERGY_1], y[base + MASS_1], k, r)
    a_s1, a_1e, a_s2, a_2e = path_areas(c, opening)
    w_1, h_1, e_1, he_1 = side_rates(
        world, c, p_1, t_1, x, a_s1, a_1e, p_s, t_s, p_e, t_e, y, dy, base, HOSE_MASS_1, HOSE_ENERGY_1
    )
    leak = external_leakage.flow(c.external_leakage, 1, p_1, t_1, world.atmosphere, world.ambient, k, r)
    h_leak = leak * cp * (t_1 if leak > 0.0 else world.ambient)
    heat = wall_heat_transfer.heat_flow(c.wall_heat_transfer, 1, y[base + WALL_1], t_1)
    dy[base + WALL_1] = moving_wall_temperature.wall_rate(
        c.moving_wall_temperature, heat, y[base + WALL_1], world.ambient
    )
    dy[base + MASS_1] = w_1 - leak
    dy[base + ENERGY_1] = h_1 - h_leak + heat - p_1 * c.area_1 * v
    dy[base + LEAKED] = leak
    dy[base + LEAKED_ENTHALPY] = h_leak
    dy[base + HEAT] = heat
    dy[base + WORK] = p_1 * c.area_1 * v
    if c.single_acting > 0.0:
        across = piston_leakage.flow(c.piston_leakage, p_1, t_1, world.atmosphere, world.ambient, k, r)
        stray(world, dy, base, MASS_1, ENERGY_1, t_1, -across)
        stray(world, dy, base, MASS_1, ENERGY_1, t_1, unknown.acting(c.unknown, 1, x, v, p_1, p_2))
        return dy[base + DRAWN], dy[base + DRAWN_ENTHALPY], e_1, he_1
    t_2 = chamber.temperature(y[base + ENERGY_2], y[base + MASS_2], k, r)
    w_2, h_2, e_2, he_2 = side_rates(
        world, c, p_2, t_2, c.stroke - x, a_s2, a_2e, p_s, t_s, p_e, t_e, y, dy, base, HOSE_MASS_2, HOSE_ENERGY_2
    )
    leak = external_leakage.flow(c.external_leakage, 2, p_2, t_2, world.atmosphere, world.ambient, k, r)
    h_leak = leak * cp * (t_2 if leak > 0.0 else world.ambient)
    heat = wall_heat_transfer.heat_flow(c.wall_heat_transfer, 2, y[base + WALL_2], t_2)
    dy[base + WALL_2] = moving_wall_temperature.wall_rate(
        c.moving_wall_temperature, heat, y[base + WALL_2], world.ambient
    )
    across = piston_leakage.flow(c.piston_leakage, p_1, t_1, p_2, t_2, k, r)
    h_across = across * cp * (t_1 if across > 0.0 else t_2)
    dy[base + MASS_1] -= across
    dy[base + ENERGY_1] -= h_across
    dy[base + MASS_2] = w_2 - leak + across
    dy[base + ENERGY_2] = h_2 - h_leak + h_across + heat + p_2 * c.area_2 * v
    dy[base + LEAKED] += leak
    dy[base + LEAKED_ENTHALPY] += h_leak
    dy[base + HEAT] += heat
    dy[base + WORK] -= p_2 * c.area_2 * v
    if unknown.present(c.unknown):
        stray(world, dy, base, MASS_1, ENERGY_1, t_1, unknown.acting(c.unknown, 1, x, v, p_1, p_2))
        stray(world, dy, base, MASS_2, ENERGY_2, t_2, unknown.acting(c.unknown, 2, x, v, p_1, p_2))
    return dy[base + DRAWN], dy[base + DRAWN_ENTHALPY], e_1 + e_2, he_1 + he_2


@kernel
def rates(world, cylinders, y, dy, held, x, v, spool):
    """Write d/dt of the integrated state; return the mass flow drawn from the supply [kg/s].

    Args:
        y, dy: Integrated state and its rate, shape (integrated_size,).
        held: The flow that the regulator's diaphragm holds [kg/s].
        x, v: Piston positions and speeds, shape (n,).
        spool: Relative openings, dead-band and offset already applied, shape (n,).
    """
    n = len(cylinders)
    shared = n * INTEGRATED
    p_s, t_s = supply_state(world, y, shared, held)
    p_e, t_e = exhaust_state(world, y, shared)
    drawn = h_drawn = vented = h_vented = 0.0
    for i in range(n):
        w, h, e, he = cylinder_rates(
            world, cylinders[i], y, dy, i * INTEGRATED, x[i], v[i], spool[i], p_s, t_s, p_e, t_e
        )
        drawn += w
        h_drawn += h
        vented += e
        h_vented += he
    for j in range(SHARED):
        dy[shared + j] = 0.0
    cp = world.k * world.r / (world.k - 1.0)
    if supply_droop.present(world.supply_droop):
        p_source = supply_regulator.pressure(world.supply_regulator, world.supply_pressure, held)
        fed = supply_droop.feed(world.supply_droop, p_source, p_s)
        dy[shared + FED] = fed
        dy[shared + FED_ENTHALPY] = fed * cp * world.supply_temperature
        dy[shared + SUPPLY_MASS] = fed - drawn
        dy[shared + SUPPLY_ENERGY] = dy[shared + FED_ENTHALPY] - h_drawn
        drawn = fed
    if exhaust_back_pressure.present(world.exhaust_back_pressure):
        out = exhaust_back_pressure.flow(
            world.exhaust_back_pressure, p_e, t_e, world.exhaust_pressure, world.ambient, world.k, world.r
        )
        dy[shared + RELEASED] = out
        dy[shared + RELEASED_ENTHALPY] = out * cp * (t_e if out > 0.0 else world.ambient)
        dy[shared + EXHAUST_MASS] = vented - out
        dy[shared + EXHAUST_ENERGY] = h_vented - dy[shared + RELEASED_ENTHALPY]
    return drawn


@kernel
def regulator_gain(world, cylinders, spool) -> float:
    """Return a bound on how much the supply's pressure falls for each pascal that it rose, by the flow that this draws."""
    if world.supply_regulator.droop <= 0.0:
        return 0.0
    if supply_droop.present(world.supply_droop):
        return world.supply_regulator.droop * world.supply_droop.conductance
    area = 0.0
    for i in range(len(cylinders)):
        a_s1, _, a_s2, _ = path_areas(cylinders[i], spool[i])
        area += a_s1 + a_s2
    steepest = gas.subsonic_flow_factor(gas.LAMINAR_RATIO, world.k) / (1.0 - gas.LAMINAR_RATIO)
    return world.supply_regulator.droop * area * steepest * math.sqrt(world.k / (world.r * world.supply_temperature))


@kernel
def integrate(world, cylinders, y, held, x0, x1, span, spool, h, stages, work, x, v):
    """Advance the integrated state by `h` seconds with pistons moving evenly from x0 to x1 over `span`; return the flow drawn.

    One Runge-Kutta-Chebyshev step. `x0` (n,) is moved on to where the pistons are afterwards.

    Args:
        work: Scratch, shape (5, integrated_size).
        x, v: Scratch, shape (n,).
    """
    n = len(cylinders)
    for i in range(n):
        v[i] = (x1[i] - x0[i]) / span
        x[i] = x0[i]
    change, first, before, there, rate = work[0], work[1], work[2], work[3], work[4]  # changes: they round less than what they change
    drawn = rates(world, cylinders, y, first, held, x, v, spool)
    a = COEFFICIENTS[stages, 1, 2] * h
    for q in range(y.size):
        before[q] = 0.0
        change[q] = a * first[q]
        there[q] = y[q] + change[q]
    for j in range(2, stages + 1):
        row = COEFFICIENTS[stages, j]
        for i in range(n):
            x[i] = x0[i] + v[i] * row[4] * h
        rates(world, cylinders, there, rate, held, x, v, spool)
        mu, nu, a, b = row[0], row[1], row[2] * h, row[3] * h
        for q in range(y.size):
            new = mu * change[q] + nu * before[q] + a * rate[q] + b * first[q]
            before[q] = change[q]
            change[q] = new
            there[q] = y[q] + new
    for q in range(y.size):
        y[q] = there[q]
    for i in range(n):
        x0[i] += v[i] * h
    return drawn


@kernel
def opening(c, spool: float) -> float:
    """Return the relative opening that a spool at this place gives, -1 to 1."""
    return valve_deadband.opening(c.valve_deadband, valve_offset.shifted(c.valve_offset, spool))


@kernel
def move_spool(c, memory, place: int, command: float, h: float) -> float:
    """Move one valve's spool on by `h` seconds of a held command; return its mean relative opening meanwhile."""
    memory[place + PLAY] = valve_hysteresis.play(c.valve_hysteresis, memory[place + PLAY], command)
    wanted = valve_lag.follow(c.valve_lag, memory[place + SPOOL], memory[place + PLAY], 0.5 * h)
    halfway = spool_rate_limit.limited(c.spool_rate_limit, memory[place + SPOOL], wanted, 0.5 * h)
    wanted = valve_lag.follow(c.valve_lag, halfway, memory[place + PLAY], 0.5 * h)
    memory[place + SPOOL] = spool_rate_limit.limited(c.spool_rate_limit, halfway, wanted, 0.5 * h)
    return opening(c, halfway)


@kernel
def advance(world, cylinders, state, x0, x1, command, dt, work, scratch):
    """Move the whole pneumatic state on by `dt` seconds.

    Args:
        world: Record WORLD.
        cylinders: Records CYLINDER, shape (n,).
        state: The state vector; changed in place.
        x0, x1: Piston positions at the start and the end, from the transmission, shape (n,) [m].
        command: Valve commands held over the step, delays already applied, shape (n,).
        work: Scratch, shape (5, integrated_size(n)).
        scratch: Scratch, shape (5, n).
    """
    n = len(cylinders)
    total = n * INTEGRATED + SHARED
    y = state[:total]
    memory = state[total:]
    shared_memory = n * REMEMBERED
    start, end, x, v, spool = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4]
    for i in range(n):
        start[i], end[i] = x0[i], x1[i]
        c = cylinders[i]
        place = i * REMEMBERED
        p_1, p_2 = pressures(world, c, y, i * INTEGRATED, memory[place + PISTON] if gives(c) else x0[i])
        if gives(c):
            start[i] = memory[place + PISTON]
            z, before = memory[place + BRISTLE], memory[place + PISTON_SPEED]
            end[i] = piston_at(world, c, p_1, p_2, start[i], x1[i], z, before, dt)
            memory[place + PISTON] = end[i]
        speed = (end[i] - start[i]) / dt
        memory[place + PISTON_SPEED] = speed
        level = dry_level(c, speed, memory[place + BRISTLE], p_1 - world.atmosphere, p_2 - world.atmosphere)
        memory[place + BRISTLE] = move_bristle(c, memory[place + BRISTLE], speed, level, dt)
    for i in range(n):  # what the joints do beyond the ends of a stroke does not squeeze the gas
        start[i], end[i] = within(cylinders[i], start[i]), within(cylinders[i], end[i])
    left = dt
    shortest = dt / (world.most_steps if world.most_steps > 0.0 else MOST_STEPS)
    while left > 1e-12:
        for i in range(n):
            here = opening(cylinders[i], memory[i * REMEMBERED + SPOOL])
            there = opening(cylinders[i], command[i])
            spool[i] = here if abs(here) > abs(there) else there
        h, stages = step_length(world, cylinders, y, memory[shared_memory + HELD], start, end, spool, left, shortest)
        for i in range(n):
            spool[i] = move_spool(cylinders[i], memory, i * REMEMBERED, command[i], h)
        drawn = integrate(
            world, cylinders, y, memory[shared_memory + HELD], start, end, left, spool, h, stages, work, x, v
        )
        slowest = h * regulator_gain(world, cylinders, spool)
        felt = supply_regulator.follow(world.supply_regulator, memory[shared_memory + FELT], drawn, h, slowest)
        memory[shared_memory + FELT] = felt
        memory[shared_memory + HELD] = supply_regulator.stick(
            world.supply_regulator, memory[shared_memory + HELD], felt
        )
        left -= h
