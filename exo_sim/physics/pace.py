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
def step_length(world, cylinders, y, held, x, end, spool, left: float, shortest: float) -> tuple[float, int]:
    """Return how long the next step may be [s], from `shortest` to `left`, and how many stages keep it stable.

    Accuracy bounds the step by the volumes that are filling, emptying or being squeezed; stability, by the fastest rate of
    all, asks for stages. A chamber and its hose are taken together; among the rest Gershgorin's circles bound it: a path
    between two volumes counts with a / V and, scaled with the roots of the volumes, with a / sqrt(V V') for what the other answers.

    Args:
        x, end: Piston positions now and when `left` is over, shape (n,).
    """
    n = len(cylinders)
    shared = n * INTEGRATED
    k, r = world.k, world.r
    p_s, t_s = supply_state(world, y, shared, held)
    p_e, _ = exhaust_state(world, y, shared)
    p_o = world.exhaust_pressure
    tank, manifold = world.supply_droop.volume, world.exhaust_back_pressure.volume
    span = min(left, world.longest_step if world.longest_step > 0.0 else LONGEST_STEP)
    transient = 0.0
    for i in range(n):
        c = cylinders[i]
        base = i * INTEGRATED
        v_1, v_2 = volumes(c, x[i])
        after_1, after_2 = volumes(c, end[i])
        squeezed_1 = abs(after_1 - v_1) / min(after_1, v_1)
        squeezed_2 = abs(after_2 - v_2) / min(after_2, v_2)
        transient = max(transient, squeezed_1 / left, squeezed_2 / left)
        p_1, p_2 = pressures(world, c, y, base, x[i])
        a_s1, a_1e, a_s2, a_2e = path_areas(c, spool[i])
        if line_restriction.present(c.line_restriction):
            v_1 = v_2 = c.line_restriction.volume
            p_1 = chamber.pressure(y[base + HOSE_ENERGY_1], v_1, k)
            p_2 = chamber.pressure(y[base + HOSE_ENERGY_2], v_2, k)
        fill_1 = transient_rate(a_s1, p_s, p_1, v_1, k, r) + transient_rate(a_1e, p_1, p_e, v_1, k, r)
        fill_2 = transient_rate(a_s2, p_s, p_2, v_2, k, r) + transient_rate(a_2e, p_2, p_e, v_2, k, r)
        transient = max(transient, fill_1, 0.0 if c.single_acting > 0.0 else fill_2)
    if exhaust_back_pressure.present(world.exhaust_back_pressure):
        transient = max(transient, transient_rate(world.exhaust_back_pressure.area, p_e, p_o, manifold, k, r))
    if transient * span > CHANGE:
        span = max(CHANGE / transient, shortest)
    drawn_rate = vented_rate = 0.0
    if supply_droop.present(world.supply_droop):
        drawn_rate = world.supply_droop.conductance * k * r * HOT / tank
    fastest = 0.0
    for i in range(n):
        c = cylinders[i]
        base = i * INTEGRATED
        v_1, v_2 = volumes(c, x[i])
        p_1, p_2 = pressures(world, c, y, base, x[i])
        a_s1, a_1e, a_s2, a_2e = path_areas(c, spool[i])
        t_1, t_2 = temperatures(world, y, base)
        warmest = max(t_s, t_1, t_2)
        across = c.piston_leakage.area
        inner_1 = path_rate(across, p_1, p_2, v_1, span, k, r) * (1.0 + math.sqrt(v_1 / v_2))
        inner_1 += path_rate(c.external_leakage.area_1, p_1, world.atmosphere, v_1, span, k, r)
        inner_1 += slow_rate(world, c, c.external_leakage.laminar_1, c.wall_heat_transfer.conductance_1, p_1, p_2, v_1)
        inner_2 = path_rate(across, p_1, p_2, v_2, span, k, r) * (1.0 + math.sqrt(v_2 / v_1))
        inner_2 += path_rate(c.external_leakage.area_2, p_2, world.atmosphere, v_2, span, k, r)
        inner_2 += slow_rate(world, c, c.external_leakage.laminar_2, c.wall_heat_transfer.conductance_2, p_2, p_1, v_2)
        if line_restriction.present(c.line_restriction):
            hose = c.line_restriction.volume
            a = c.line_restriction.area
            h_1 = chamber.pressure(y[base + HOSE_ENERGY_1], hose, k)
            h_2 = chamber.pressure(y[base + HOSE_ENERGY_2], hose, k)
            through_1, share_1 = path_rate(a, h_1, p_1, hose, span, k, r), hose / v_1
            through_2, share_2 = path_rate(a, h_2, p_2, hose, span, k, r), hose / v_2
            inner_1 += through_1 * share_1
            inner_2 += through_2 * share_2
            p_1, p_2, v_1, v_2 = h_1, h_2, hose, hose
            t_1 = chamber.temperature(y[base + HOSE_ENERGY_1], y[base + HOSE_MASS_1], k, r)
            t_2 = chamber.temperature(y[base + HOSE_ENERGY_2], y[base + HOSE_MASS_2], k, r)
            warmest = max(warmest, t_1, t_2)
        fed_1, fed_2 = path_rate(a_s1, p_s, p_1, v_1, span, k, r), path_rate(a_s2, p_s, p_2, v_2, span, k, r)
        let_off_1, let_off_2 = path_rate(a_1e, p_1, p_e, v_1, span, k, r), path_rate(a_2e, p_2, p_e, v_2, span, k, r)
        if tank > 0.0:
            drawn_rate += fed_1 * (v_1 / tank + math.sqrt(v_1 / tank)) + fed_2 * (v_2 / tank + math.sqrt(v_2 / tank))
            fed_1, fed_2 = fed_1 * (1.0 + math.sqrt(v_1 / tank)), fed_2 * (1.0 + math.sqrt(v_2 / tank))
        if exhaust_back_pressure.present(world.exhaust_back_pressure):
            vented_rate += let_off_1 * (v_1 / manifold + math.sqrt(v_1 / manifold))
            vented_rate += let_off_2 * (v_2 / manifold + math.sqrt(v_2 / manifold))
            let_off_1, let_off_2 = let_off_1 * (1.0 + math.sqrt(v_1 / manifold)), let_off_2 * (1.0 + math.sqrt(v_2 / manifold))
        valve_1, valve_2 = fed_1 + let_off_1, fed_2 + let_off_2
        if line_restriction.present(c.line_restriction):
            inner_1 = coupled_rate(inner_1, through_1 + valve_1, through_1 * through_1 * share_1)
            inner_2 = coupled_rate(inner_2, through_2 + valve_2, through_2 * through_2 * share_2)
        else:
            inner_1 += valve_1
            inner_2 += valve_2
        inner = max(inner_1, 0.0 if c.single_acting > 0.0 else inner_2)
        fastest = max(fastest, inner * math.sqrt(_WARMER * warmest / HOT))
    vented_rate += path_rate(world.exhaust_back_pressure.area, p_e, p_o, max(manifold, 1e-9), span, k, r)
    fastest = max(fastest, drawn_rate, vented_rate)
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
