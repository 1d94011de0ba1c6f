"""How long the next step of the gas may be, and how many stages keep it stable."""

from __future__ import annotations

import math

from exo_sim.physics import chamber
from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.effects import end_cushioning, exhaust_back_pressure, heat_transfer_law, line_restriction, supply_droop
from exo_sim.physics.gas_effects_off import plain
from exo_sim.physics.nodes import chambers, exhaust_state, path_areas, pressures, supply_state, tank_state, volumes
from exo_sim.physics.recovery_tank import exchange_rate
from exo_sim.physics.runge_kutta_chebyshev import MOST_STAGES, REACH, enough_stages
from exo_sim.physics.settling import HOT, HotGas, hot_gas, path_rate, settling_rate, thermal_rate
from exo_sim.physics.state import HOSE_ENERGY_1, HOSE_ENERGY_2, HOSE_FLOW_1, HOSE_MASS_1, HOSE_MASS_2, INTEGRATED, MIDDLE_FLOW_1
from exo_sim.physics.step import CLASSIC, CLASSIC_REACH, CLASSIC_STAGES
from exo_sim.physics.summed_effects import across_rate, heat_rate, outward_rate

#: The longest step that accuracy allows [s]; stability asks for more stages, not for shorter steps.
LONGEST_STEP = 1e-3

#: The most steps in one call: a gas that asks for more is no longer one that this model describes.
MOST_STEPS = 2000

#: The share of itself by which a pressure may change in one step.
CHANGE = 0.4

#: How far a wave in a line turns in one step [rad]: further, and a Chebyshev step's own gain exceeds the wall's friction; a classic one
#: takes 8 % from the fastest wave of a hose then (its stability function: 1 - z^6/72 + z^8/576 is the square of what stays), and 0.2 %
#: from one half as fast. Predictions of two learn machines with 1.1 and 1.6 m of hose are off by 9 to 23 Pa, with 1.2 rad by 2 to 13.
_TURN, CLASSIC_TURN = CHANGE / 1.5, 1.6

#: A path with pressures closer than this ratio counts as balanced: what is left settles stably in steps of any length.
_BALANCED = 0.97

#: By how much gas may become warmer in a step where its temperature is known.
_WARMER = 1.1


@inlined_kernel
def transient_rate(area: float, p_up: float, p_down: float, volume: float, gas: HotGas) -> float:
    """Return how fast a path changes the pressure of a volume that is not yet balanced behind it [1/s]; accuracy asks for it."""
    if area <= 0.0 or min(p_up, p_down) > _BALANCED * max(p_up, p_down):
        return 0.0
    return settling_rate(area, volume, gas)


@inlined_kernel
def coupled_rate(one: float, other: float, product: float) -> float:
    """Return the faster mode of two volumes that settle at rates `one` and `other` alone and answer each other by this product."""
    return 0.5 * (one + other) + math.sqrt(0.25 * (one - other) ** 2 + product)


@inlined_kernel
def rate_of_effects(world, c, here, there, span):
    """Return a bound on how fast a chamber and its wall can settle by all that effects add to the chamber's balances [1/s]."""
    rate = across_rate(c, here, there, span, world) + outward_rate(c, here, there, span, world)
    thermal = heat_rate(c, here, world) * heat_transfer_law.steepest(c.heat_transfer_law, here)
    rate += thermal
    wall = c.moving_wall_temperature
    if wall.heat_capacity > 0.0:
        conductance = thermal * here.p * here.volume / ((world.k - 1.0) * HOT)
        rate += (conductance + wall.outside_conductance) / wall.heat_capacity
    return rate


@inlined_kernel
def side_rate(world, c, y, base, here, a_supply, a_exhaust, supply, exhaust, span, added, gas):
    """Return how fast one chamber and its hose can settle within `span` seconds, and what they add to an accumulator's and a manifold's
    rate [1/s].

    A chamber and its hose are taken together. Among the rest Gershgorin's circles bound the fastest mode: a path between two volumes
    counts with a / V and, scaled with the roots of the volumes, with a / sqrt(V V') for what the other answers.

    Args:
        y: Integrated state; the cylinder's part begins at `base`.
        here: This `Chamber`.
        a_supply, a_exhaust, supply, exhaust: Areas of the valve's paths [m^2], and the `Reservoir` behind each.
        added: How fast the chamber settles by what effects add to its balances [1/s].
        gas: The `HotGas`.
    """
    k, r = world.k, world.r
    rate = added
    warmest = max(here.t, supply.t)
    through = share = wall = 0.0
    p, v = here.p, here.volume
    hose = line_restriction.present(c.line_restriction)
    if hose:
        mass = base + (HOSE_MASS_1 if here.side == 1 else HOSE_MASS_2)
        energy = base + (HOSE_ENERGY_1 if here.side == 1 else HOSE_ENERGY_2)
        v = line_restriction.node_volume(c.line_restriction)
        p = chamber.pressure(y[energy], v, k)
        warmest = max(warmest, chamber.temperature(y[energy], y[mass], k, r))
        wall = thermal_rate(c.line_restriction.conductance, min(p, here.p), c.line_restriction.volume, k)
        if not line_restriction.has_inertia(c.line_restriction):  # else `fastest_wave` and `fastest_friction` bound it
            through, share = path_rate(c.line_restriction.area, p, here.p, v, span, gas), v / here.volume
            rate += through * share
    fed = path_rate(a_supply, supply.p, p, v, span, gas)
    let_off = path_rate(a_exhaust, p, exhaust.p, v, span, gas)
    valve = fed + let_off
    drawn = vented = 0.0
    if supply_droop.present(world.supply_droop):
        answer = math.sqrt(v / world.supply_droop.volume)
        drawn = fed * answer * (answer + 1.0)
        valve += fed * answer
    if exhaust_back_pressure.present(world.exhaust_back_pressure):
        answer = math.sqrt(v / world.exhaust_back_pressure.volume)
        vented = let_off * answer * (answer + 1.0)
        valve += let_off * answer
    rate = wall + (coupled_rate(rate, through + valve, through * through * share) if hose else rate + valve)
    return rate * math.sqrt(_WARMER * warmest / HOT), drawn, vented


@inlined_kernel
def fastest_rate(world, cylinders, y, supply, exhaust, x, spool, span, gas):
    """Return a bound on how fast anything can settle within `span` seconds [1/s]; `gas` is the `HotGas`."""
    k, r = world.k, world.r
    tank, manifold = world.supply_droop, world.exhaust_back_pressure
    drawn = tank.conductance * k * r * HOT / tank.volume if supply_droop.present(tank) else 0.0
    vented = path_rate(manifold.area, exhaust.p, world.exhaust_pressure, max(manifold.volume, 1e-9), span, gas)
    fastest = 0.0
    for i in range(len(cylinders)):
        c, base = cylinders[i], i * INTEGRATED
        one, two = chambers(world, c, y, base, x[i], 0.0)
        a_s1, a_1e, a_s2, a_2e = path_areas(c, spool[i], spool[len(cylinders) + i])
        added_1 = added_2 = 0.0
        if not plain(c):
            added_1, added_2 = rate_of_effects(world, c, one, two, span), rate_of_effects(world, c, two, one, span)
        if world.tank_volume > 0.0:
            recovered = tank_state(world, y, len(cylinders) * INTEGRATED)
            added_1 += exchange_rate(world, c, one, spool[2 * len(cylinders) + i], recovered, span)
            added_2 += exchange_rate(world, c, two, spool[3 * len(cylinders) + i], recovered, span)
        rate, more, less = side_rate(world, c, y, base, one, a_s1, a_1e, supply, exhaust, span, added_1, gas)
        fastest, drawn, vented = max(fastest, rate), drawn + more, vented + less
        if c.single_acting == 0.0:
            rate, more, less = side_rate(world, c, y, base, two, a_s2, a_2e, supply, exhaust, span, added_2, gas)
            fastest, drawn, vented = max(fastest, rate), drawn + more, vented + less
    return max(fastest, drawn, vented)


@inlined_kernel
def fastest_change(world, cylinders, y, supply, exhaust, x, end, spool, left, gas):
    """Return how fast the volumes that are filling, emptying or being squeezed change their pressure [1/s]: accuracy asks for it."""
    k = world.k
    p_s, p_e, manifold = supply.p, exhaust.p, world.exhaust_back_pressure
    change = 0.0
    for i in range(len(cylinders)):
        c, base = cylinders[i], i * INTEGRATED
        v_1, v_2 = volumes(c, x[i])
        after_1, after_2 = volumes(c, end[i])
        squeezed_1 = abs(after_1 - v_1) / min(after_1, v_1)
        squeezed_2 = abs(after_2 - v_2) / min(after_2, v_2)
        change = max(change, squeezed_1 / left, squeezed_2 / left)
        p_1, p_2 = pressures(world, c, y, base, x[i])
        a_s1, a_1e, a_s2, a_2e = path_areas(c, spool[i], spool[len(cylinders) + i])
        if line_restriction.present(c.line_restriction):
            v_1 = v_2 = line_restriction.node_volume(c.line_restriction)
            p_1 = chamber.pressure(y[base + HOSE_ENERGY_1], v_1, k)
            p_2 = chamber.pressure(y[base + HOSE_ENERGY_2], v_2, k)
        fill_1 = transient_rate(a_s1, p_s, p_1, v_1, gas) + transient_rate(a_1e, p_1, p_e, v_1, gas)
        fill_2 = transient_rate(a_s2, p_s, p_2, v_2, gas) + transient_rate(a_2e, p_2, p_e, v_2, gas)
        if world.tank_volume > 0.0:
            p_t = tank_state(world, y, len(cylinders) * INTEGRATED).p
            fill_1 += transient_rate(max(spool[2 * len(cylinders) + i], 0.0) * c.tank_area, p_t, p_1, v_1, gas)
            fill_2 += transient_rate(max(spool[3 * len(cylinders) + i], 0.0) * c.tank_area, p_t, p_2, v_2, gas)
        change = max(change, fill_1, 0.0 if c.single_acting > 0.0 else fill_2)
    if exhaust_back_pressure.present(manifold):
        change = max(change, transient_rate(manifold.area, p_e, world.exhaust_pressure, manifold.volume, gas))
    return change


@inlined_kernel
def fastest_wave(world, cylinders):
    """Return a bound on the angular frequency of the waves in all hoses [1/s]; 0 without any."""
    fastest = 0.0
    for i in range(len(cylinders)):
        hose = cylinders[i].line_restriction
        if line_restriction.has_inertia(hose):
            fastest = max(fastest, line_restriction.wave_rate(hose, world.ambient, world.k, world.r))
    return fastest


@inlined_kernel
def fastest_friction(world, cylinders, y, x, end):
    """Return how fast throttles take away the flows in all hoses that have inertia, those of now or those they let through [1/s].

    A cushion that all but closes the port of a hose makes its throttle a thousand times as strong for what leaves the chamber.

    Args:
        x, end: Piston positions now and at the end of what is to be stepped through, shape (n,).
    """
    k, r = world.k, world.r
    fastest = 0.0
    for i in range(len(cylinders)):
        c, base = cylinders[i], i * INTEGRATED
        hose = c.line_restriction
        if not line_restriction.has_inertia(hose):
            continue
        one, two = chambers(world, c, y, base, x[i], 0.0)
        for here in (one, two):
            if here.side == 2 and c.single_acting > 0.0:
                continue
            place = base + 2 * (here.side - 1)
            p = chamber.pressure(y[place + HOSE_ENERGY_1], line_restriction.node_volume(hose), k)
            t = chamber.temperature(y[place + HOSE_ENERGY_1], y[place + HOSE_MASS_1], k, r)
            depth = min(here.depth, end[i] if here.side == 1 else c.stroke - end[i])
            outlet = end_cushioning.outlet(c.end_cushioning, hose.area, depth)
            whole, at_chamber = line_restriction.resistances(hose, outlet, p, t, here.p, here.t, k, r)
            driven = abs(p - here.p)
            first = max(abs(y[place + HOSE_FLOW_1]), math.sqrt(driven / whole))
            leaving = max(-y[place + MIDDLE_FLOW_1], math.sqrt(driven / at_chamber))
            fastest = max(fastest, line_restriction.friction_rate(hose, whole, max(first, abs(y[place + MIDDLE_FLOW_1]))))
            fastest = max(fastest, line_restriction.friction_rate(hose, at_chamber, leaving))
    return fastest


@inlined_kernel
def until_cushions(cylinders, x, end, left) -> float:
    """Return when a piston next comes to or leaves a cushion [s], at most `left`.

    There the area of a path jumps: a step across it is off in proportion to its length, and by how much turns on where its stages fall.

    Args:
        x, end: Piston positions now and when `left` is over, shape (n,).
    """
    soonest = left
    for i in range(len(cylinders)):
        c = cylinders[i]
        if c.end_cushioning.length > 0.0 and end[i] != x[i]:
            begins = end_cushioning.reached(c.end_cushioning, x[i], end[i], c.stroke)
            soonest = min(soonest, begins * left)
    return soonest


@inlined_kernel
def step_length(world, cylinders, y, held, x, end, spool, left: float, shortest: float, faster: float) -> tuple[float, int]:
    """Return how long the next step may be [s], from `shortest` to `left`, and how many stages keep it stable; or `CLASSIC` for these.

    Args:
        faster: How fast the gas is known to be otherwise [1/s].
        x, end: Piston positions now and when `left` is over, shape (n,).
    """
    shared = len(cylinders) * INTEGRATED
    supply, exhaust = supply_state(world, y, shared, held), exhaust_state(world, y, shared)
    span = min(left, world.longest_step if world.longest_step > 0.0 else LONGEST_STEP)
    gas = hot_gas(world.k, world.r)
    until = until_cushions(cylinders, x, end, left)
    change = fastest_change(world, cylinders, y, supply, exhaust, x, end, spool, left, gas)
    if change * span > CHANGE:
        span = max(CHANGE / change, shortest)
    fastest = max(fastest_rate(world, cylinders, y, supply, exhaust, x, spool, span, gas), faster)
    wave = fastest_wave(world, cylinders)
    if wave > 0.0:
        friction = fastest_friction(world, cylinders, y, x, end)
        fastest = max(fastest, friction)
        classic, stiff = min(span, CLASSIC_TURN / wave), max(faster, friction)
        if stiff * classic > CLASSIC_REACH:  # of what else settles no bound is asked: a classic step itself is (`step.py`)
            classic = CLASSIC_REACH / stiff
        turned = min(span, _TURN / wave)
        if classic >= shortest and CLASSIC_STAGES * turned < enough_stages(fastest * turned) * classic:
            return min(left / max(math.ceil(left / classic - 1e-9), 1), until), CLASSIC
        span = min(span, max(turned, shortest))
    h = left / max(math.ceil(left / span - 1e-9), 1)
    if not fastest * h <= REACH[MOST_STAGES]:
        pieces = left * fastest / REACH[MOST_STAGES]
        if not pieces < left / shortest:  # also what is not a number any more
            pieces = left / shortest
        h = left / max(math.ceil(pieces), 1)
    return min(h, until), enough_stages(fastest * h)
