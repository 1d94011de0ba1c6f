"""How long the next step of the gas may be, and how many stages keep it stable."""

from __future__ import annotations

import math

from exo_sim.physics import chamber, gas
from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects import exhaust_back_pressure, line_restriction, supply_droop
from exo_sim.physics.integrator import MOST_STAGES, REACH
from exo_sim.physics.nodes import exhaust_state, path_areas, pressures, supply_state, temperatures, volumes
from exo_sim.physics.state import HOSE_ENERGY_1, HOSE_ENERGY_2, HOSE_MASS_1, HOSE_MASS_2, INTEGRATED

#: The longest step that accuracy allows [s]; stability asks for more stages, not for shorter steps.
LONGEST_STEP = 1e-3

#: The most steps in one call: a gas that asks for more is no longer one that this model describes.
MOST_STEPS = 2000

#: The share of itself by which a pressure may change in one step.
CHANGE = 0.4

#: A path with pressures closer than this ratio counts as balanced: what is left settles stably in steps of any length.
_BALANCED = 0.97

#: Temperature that the bounds on rates assume of the gas [K] ...
HOT = 400.0

#: ... and by how much it may become warmer in a step where it is known.
_WARMER = 1.1


@kernel
def settling_rate(area: float, volume: float, k: float, r: float) -> float:
    """Return how fast a volume behind one choked path fills or empties [1/s]."""
    return k * area * math.sqrt(k * r * HOT) / volume


@kernel
def path_rate(area: float, p_up: float, p_down: float, volume: float, span: float, k: float, r: float) -> float:
    """Return a bound on how fast a volume behind one path can settle within `span` seconds [1/s].

    B15's time constant, inverted. The flow's slope steepens towards equal pressures, so it is taken where the span may lead.
    """
    if area <= 0.0:
        return 0.0
    settling = settling_rate(area, volume, k, r)
    left = 1.0 - min(p_up, p_down) / max(p_up, p_down) - settling * span - 0.02
    knee = 1.0 - gas.LAMINAR_RATIO
    if left <= knee:
        return settling * gas.subsonic_flow_factor(gas.LAMINAR_RATIO, k) / knee
    return settling * max(0.8 / math.sqrt(left), 1.0)


@kernel
def transient_rate(area: float, p_up: float, p_down: float, volume: float, k: float, r: float) -> float:
    """Return how fast a path changes the pressure of a volume that is not yet balanced behind it [1/s]; accuracy asks for it."""
    if area <= 0.0 or min(p_up, p_down) > _BALANCED * max(p_up, p_down):
        return 0.0
    return settling_rate(area, volume, k, r)


@kernel
def slow_rate(world, c, laminar: float, conductance: float, p: float, p_other: float, volume: float) -> float:
    """Return a bound on how fast a chamber settles by laminar leaks and heat [1/s]: slow, unless a rig asks for much of it."""
    k, r = world.k, world.r
    rate = 2.0 * (laminar * p + c.piston_leakage.laminar * max(p, p_other)) * k * r * HOT / volume
    heat = conductance + c.wall_heat_transfer.conductance
    rate += heat * (k - 1.0) * HOT / (p * volume)
    if c.moving_wall_temperature.heat_capacity > 0.0:
        rate += (heat + c.moving_wall_temperature.outside_conductance) / c.moving_wall_temperature.heat_capacity
    return rate


@kernel
def coupled_rate(one: float, other: float, product: float) -> float:
    """Return the faster mode of two volumes that settle at rates `one` and `other` alone and answer each other by this product."""
    return 0.5 * (one + other) + math.sqrt(0.25 * (one - other) ** 2 + product)


@kernel
def side_rate(world, c, y, hose_mass, hose_energy, p, t, v, p_other, v_other, leak, laminar, conductance, a_supply, p_s, t_s, a_exhaust,
              p_e, span):  # fmt: skip
    """Return how fast one chamber and its hose can settle within `span` seconds, and what they add to an accumulator's and a manifold's
    rate [1/s].

    A chamber and its hose are taken together. Among the rest Gershgorin's circles bound the fastest mode: a path between two volumes
    counts with a / V and, scaled with the roots of the volumes, with a / sqrt(V V') for what the other answers.

    Args:
        y: Integrated state; `hose_mass` and `hose_energy` are the places of this side's hose in it.
        p, t, v, p_other, v_other: State of this chamber, and of the other one.
        leak, laminar, conductance: To the outside, of this side.
        a_supply, p_s, t_s, a_exhaust, p_e: Of the valve's paths.
    """
    k, r = world.k, world.r
    rate = path_rate(c.piston_leakage.area, p, p_other, v, span, k, r) * (1.0 + math.sqrt(v / v_other))
    rate += path_rate(leak, p, world.atmosphere, v, span, k, r)
    rate += slow_rate(world, c, laminar, conductance, p, p_other, v)
    warmest = max(t, t_s)
    through = share = 0.0
    hose = line_restriction.present(c.line_restriction)
    if hose:
        inside, room = p, v
        v = c.line_restriction.volume
        p = chamber.pressure(y[hose_energy], v, k)
        warmest = max(warmest, chamber.temperature(y[hose_energy], y[hose_mass], k, r))
        through, share = path_rate(c.line_restriction.area, p, inside, v, span, k, r), v / room
        rate += through * share
    fed = path_rate(a_supply, p_s, p, v, span, k, r)
    let_off = path_rate(a_exhaust, p, p_e, v, span, k, r)
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
    rate = coupled_rate(rate, through + valve, through * through * share) if hose else rate + valve
    return rate * math.sqrt(_WARMER * warmest / HOT), drawn, vented


@kernel
def fastest_rate(world, cylinders, y, p_s, t_s, p_e, x, spool, span):
    """Return a bound on how fast anything can settle within `span` seconds [1/s]."""
    k, r = world.k, world.r
    supply, exhaust = world.supply_droop, world.exhaust_back_pressure
    drawn = supply.conductance * k * r * HOT / supply.volume if supply_droop.present(supply) else 0.0
    vented = path_rate(exhaust.area, p_e, world.exhaust_pressure, max(exhaust.volume, 1e-9), span, k, r)
    fastest = 0.0
    for i in range(len(cylinders)):
        c, base = cylinders[i], i * INTEGRATED
        v_1, v_2 = volumes(c, x[i])
        p_1, p_2 = pressures(world, c, y, base, x[i])
        t_1, t_2 = temperatures(world, y, base)
        a_s1, a_1e, a_s2, a_2e = path_areas(c, spool[i])
        leak, wall = c.external_leakage, c.wall_heat_transfer
        rate, more, less = side_rate(
            world, c, y, base + HOSE_MASS_1, base + HOSE_ENERGY_1, p_1, t_1, v_1, p_2, v_2,
            leak.area_1, leak.laminar_1, wall.conductance_1, a_s1, p_s, t_s, a_1e, p_e, span,
        )  # fmt: skip
        fastest, drawn, vented = max(fastest, rate), drawn + more, vented + less
        if c.single_acting > 0.0:
            continue
        rate, more, less = side_rate(
            world, c, y, base + HOSE_MASS_2, base + HOSE_ENERGY_2, p_2, t_2, v_2, p_1, v_1,
            leak.area_2, leak.laminar_2, wall.conductance_2, a_s2, p_s, t_s, a_2e, p_e, span,
        )  # fmt: skip
        fastest, drawn, vented = max(fastest, rate), drawn + more, vented + less
    return max(fastest, drawn, vented)


@kernel
def fastest_change(world, cylinders, y, p_s, p_e, x, end, spool, left):
    """Return how fast the volumes that are filling, emptying or being squeezed change their pressure [1/s]: accuracy asks for it."""
    k, r = world.k, world.r
    exhaust = world.exhaust_back_pressure
    change = 0.0
    for i in range(len(cylinders)):
        c, base = cylinders[i], i * INTEGRATED
        v_1, v_2 = volumes(c, x[i])
        after_1, after_2 = volumes(c, end[i])
        squeezed_1 = abs(after_1 - v_1) / min(after_1, v_1)
        squeezed_2 = abs(after_2 - v_2) / min(after_2, v_2)
        change = max(change, squeezed_1 / left, squeezed_2 / left)
        p_1, p_2 = pressures(world, c, y, base, x[i])
        a_s1, a_1e, a_s2, a_2e = path_areas(c, spool[i])
        if line_restriction.present(c.line_restriction):
            v_1 = v_2 = c.line_restriction.volume
            p_1 = chamber.pressure(y[base + HOSE_ENERGY_1], v_1, k)
            p_2 = chamber.pressure(y[base + HOSE_ENERGY_2], v_2, k)
        fill_1 = transient_rate(a_s1, p_s, p_1, v_1, k, r) + transient_rate(a_1e, p_1, p_e, v_1, k, r)
        fill_2 = transient_rate(a_s2, p_s, p_2, v_2, k, r) + transient_rate(a_2e, p_2, p_e, v_2, k, r)
        change = max(change, fill_1, 0.0 if c.single_acting > 0.0 else fill_2)
    if exhaust_back_pressure.present(exhaust):
        change = max(change, transient_rate(exhaust.area, p_e, world.exhaust_pressure, exhaust.volume, k, r))
    return change


@kernel
def step_length(world, cylinders, y, held, x, end, spool, left: float, shortest: float) -> tuple[float, int]:
    """Return how long the next step may be [s], from `shortest` to `left`, and how many stages keep it stable.

    Args:
        x, end: Piston positions now and when `left` is over, shape (n,).
    """
    shared = len(cylinders) * INTEGRATED
    p_s, t_s = supply_state(world, y, shared, held)
    p_e, _ = exhaust_state(world, y, shared)
    span = min(left, world.longest_step if world.longest_step > 0.0 else LONGEST_STEP)
    change = fastest_change(world, cylinders, y, p_s, p_e, x, end, spool, left)
    if change * span > CHANGE:
        span = max(CHANGE / change, shortest)
    fastest = fastest_rate(world, cylinders, y, p_s, t_s, p_e, x, spool, span)
    h = left / max(math.ceil(left / span - 1e-9), 1)
    if not fastest * h <= REACH[MOST_STAGES]:
        pieces = left * fastest / REACH[MOST_STAGES]
        if not pieces < left / shortest:  # also what is not a number any more
            pieces = left / shortest
        h = left / max(math.ceil(pieces), 1)
    stages = 2
    while stages < MOST_STAGES and REACH[stages] < fastest * h:
        stages += 1
    return h, stages
