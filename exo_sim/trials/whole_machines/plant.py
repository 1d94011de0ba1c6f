"""Rates of change of a whole machine.

Every gas volume carries mass and internal energy; its pressure is (k - 1) U / V. A hose is one volume behind an orifice, or a short
line of three volumes between which gas has inertia and rubs at the wall. The load is a slide or a lever; between it and the piston
there may be a mount that gives, with play. Where a wearer leads the load its speed and acceleration are given (`LED`).
"""

from __future__ import annotations

import math

from exo_sim.trials.whole_machines.compiled import kernel
from exo_sim.trials.whole_machines.friction_laws import contact, level, viscous
from exo_sim.trials.whole_machines.gas_laws import ELLIPSE, conductance, leak, orifice
from exo_sim.trials.whole_machines.hose import CELLS, hose_rates

# places in the state vector
Q, QD, X, V, N1, U1, N2, U2, NX, UX, NT, UT, REG, REG_V, W1, W2, SPOOL, SPOOL_V, BRISTLE, REST, WARM, LED = range(22)
LINE_1 = 22  # mass, energy of each cell, then the flows out of them towards the chamber
LINE_2 = LINE_1 + 3 * CELLS
STATES = LINE_2 + 3 * CELLS
#: What `rates` says besides: pressures in the chambers and at the valve, supply and exhaust pressure, force on the load, temperatures,
#: friction, flow out of the supply, piston position and speed, gas force.
P1, P2, PV1, PV2, SUPPLY, EXHAUST, FORCE, T1, T2, FRICTION, DRAWN, PISTON, SPEED, GAS = range(14)
SAID = 14


@kernel
def transmission(q, p):
    """Return the rod position, its slope over the joint, and the slope's slope."""
    if p.lever == 0.0:
        return q + p.zero, 1.0, 0.0
    angle = q + p.lever_angle
    product = p.lever_arm * p.lever_base
    length = math.sqrt(p.lever_arm * p.lever_arm + p.lever_base * p.lever_base - 2.0 * product * math.cos(angle))
    slope = product * math.sin(angle) / length
    return length - p.lever_length, slope, (product * math.cos(angle) - slope * slope) / length


@kernel
def opening(spool, lap, curve):
    """Return the opening 0..1 of a metering edge."""
    o = (spool - lap) / (1.0 - lap)
    if o <= 0.0:
        return 0.0
    if o >= 1.0:
        return 1.0
    return o if curve == 1.0 else o**curve


@kernel
def valve_path(area, p_a, t_a, p_b, t_b, p):
    """Return the mass flow of one path of the valve from a to b [kg/s]."""
    return orifice(area, p_a, t_a, p_b, t_b, p.flow_law, p.flow_b, p.flow_m, p.crack, p, p.flow_laminar)


@kernel
def behind_play(spool, place, width):
    """Return where a valve stands behind a play whose whole loop is `width` wide, having stood at `place`."""
    return min(max(place, spool - 0.5 * width), spool + 0.5 * width)


@kernel
def spool_rates(y, u, p, out):
    """Write the rates of the spool that is commanded u."""
    if p.spool_frequency > 0.0:
        omega = 2.0 * math.pi * p.spool_frequency
        out[SPOOL] = y[SPOOL_V]
        out[SPOOL_V] = omega * omega * (u - y[SPOOL]) - 2.0 * p.spool_damping * omega * y[SPOOL_V]
        if p.rate > 0.0:
            out[SPOOL] = min(max(out[SPOOL], -p.rate), p.rate)
    elif p.lag > 0.0:
        # a spring closes as slowly as it does, whatever the coil that opens
        returning = p.lag_back > 0.0 and (u - y[SPOOL]) * y[SPOOL] < 0.0
        out[SPOOL] = (u - y[SPOOL]) / (p.lag_back if returning else p.lag)
        if p.rate > 0.0:
            out[SPOOL] = min(max(out[SPOOL], -p.rate), p.rate)


@kernel
def rates(y, place, u, p, out, said):
    """Write the rate of change of the state, and what else there is to say.

    Args:
        y: State, shape (STATES,).
        place: Where the valve stood behind the spool's play before the step.
        u: Command that has arrived at the spool.
        p: The machine.
        out: Written, shape (STATES,).
        said: Written, shape (SAID,).
    """
    for i in range(STATES):
        out[i] = 0.0
    k, gas = p.heat_ratio, p.gas_constant
    cp = k * gas / (k - 1.0)
    ambient, room = p.ambient, p.room
    rod, slope, bend = transmission(y[Q], p)
    soft = p.mount_stiffness > 0.0
    x, v = (y[X], y[V]) if soft else (rod, slope * y[QD])
    v1 = p.dead_1 + p.area_1 * x
    v2 = p.dead_2 + p.area_2 * (p.stroke - x)
    p1 = (k - 1.0) * y[U1] / v1
    t1 = p1 * v1 / (y[N1] * gas)
    if p.single_acting > 0.0:
        p2, t2 = ambient, room
    else:
        p2 = (k - 1.0) * y[U2] / v2
        t2 = p2 * v2 / (y[N2] * gas)
    hose = p.hose_kind > 0.0
    pv1, tv1, pv2, tv2 = p1, t1, p2, t2
    if hose:
        volume = p.hose_volume if p.hose_kind == 1.0 else 0.25 * math.pi * p.hose_bore**2 * p.hose_length / CELLS
        pv1 = (k - 1.0) * y[LINE_1 + 1] / volume
        tv1 = pv1 * volume / (y[LINE_1] * gas)
        pv2 = (k - 1.0) * y[LINE_2 + 1] / volume
        tv2 = pv2 * volume / (y[LINE_2] * gas)
    supply, t_supply = p.supply, room
    if p.tank_volume > 0.0:
        supply = (k - 1.0) * y[UT] / p.tank_volume
        t_supply = supply * p.tank_volume / (y[NT] * gas)
    elif p.regulator_droop > 0.0:
        supply = y[REG]
    exhaust, t_exhaust = ambient, room
    if p.exhaust_area > 0.0:
        exhaust = (k - 1.0) * y[UX] / p.exhaust_volume
        t_exhaust = exhaust * p.exhaust_volume / (y[NX] * gas)

    # valve
    s = behind_play(y[SPOOL], place, p.play) + p.shift
    full, closed = p.valve_area, p.null_area
    s1 = full * p.edge_s1 * opening(s, p.lap_s1, p.curve) + closed
    e2 = full * p.edge_e2 * opening(s, p.lap_e2, p.curve) + closed
    e1 = full * p.edge_e1 * opening(-s, p.lap_e1, p.curve) + closed
    s2 = full * p.edge_s2 * opening(-s, p.lap_s2, p.curve) + closed
    in_1 = valve_path(s1, supply, t_supply, pv1, tv1, p)
    out_1 = valve_path(e1, pv1, tv1, exhaust, t_exhaust, p)
    net_1 = in_1 - out_1
    back_1 = cp * out_1 * (tv1 if out_1 > 0.0 else t_exhaust)
    h_1 = cp * in_1 * (t_supply if in_1 > 0.0 else tv1) - back_1
    in_2, out_2, net_2, h_2, back_2 = 0.0, 0.0, 0.0, 0.0, 0.0
    if p.single_acting <= 0.0:
        in_2 = valve_path(s2, supply, t_supply, pv2, tv2, p)
        out_2 = valve_path(e2, pv2, tv2, exhaust, t_exhaust, p)
        net_2 = in_2 - out_2
        back_2 = cp * out_2 * (tv2 if out_2 > 0.0 else t_exhaust)
        h_2 = cp * in_2 * (t_supply if in_2 > 0.0 else tv2) - back_2
    if hose:
        needle_1 = p.cushion_area if x < p.cushion_length else 0.0
        needle_2 = p.cushion_area if p.stroke - x < p.cushion_length else 0.0
        net_1, h_1 = hose_rates(y, out, LINE_1, p1, t1, net_1, h_1, needle_1, p)
        if p.single_acting <= 0.0:
            net_2, h_2 = hose_rates(y, out, LINE_2, p2, t2, net_2, h_2, needle_2, p)

    # leaks
    w = leak(p.leak_piston, p1, t1, p2, t2, p.leak_law, p.leak_inertial, p.leak_turning, p)
    carried = cp * w * (t1 if w > 0.0 else t2)
    net_1, net_2, h_1, h_2 = net_1 - w, net_2 + w, h_1 - carried, h_2 + carried
    w = leak(p.leak_1, p1, t1, ambient, room, p.leak_law, p.leak_inertial, p.leak_turning, p)
    if p.relief_gain > 0.0 and p1 > p.relief_pressure:
        w += orifice(p.relief_gain * (p1 - p.relief_pressure), p1, t1, ambient, room, ELLIPSE, 0.3, 0.5, 0.0, p)
    net_1, h_1 = net_1 - w, h_1 - cp * w * (t1 if w > 0.0 else room)
    w = leak(p.leak_2, p2, t2, ambient, room, p.leak_law, p.leak_inertial, p.leak_turning, p)
    net_2, h_2 = net_2 - w, h_2 - cp * w * (t2 if w > 0.0 else room)

    # walls
    barrel = 2.0 * math.sqrt(math.pi * p.area_1)
    g1 = conductance(p.heat_law, p.heat_conductance, p.heat_coefficient, 2.0 * p.area_1, barrel, x, p1, t1, v)
    g2 = conductance(p.heat_law, p.heat_conductance, p.heat_coefficient, 2.0 * p.area_2, barrel, p.stroke - x, p2, t2, v)
    q1, q2 = g1 * (y[W1] - t1), g2 * (y[W2] - t2)
    if p.wall_capacity > 0.0:
        out[W1] = (-q1 - p.wall_outside * (y[W1] - room)) / p.wall_capacity
        out[W2] = (-q2 - p.wall_outside * (y[W2] - room)) / p.wall_capacity
    out[N1], out[U1] = net_1, h_1 + q1 - p1 * p.area_1 * v
    if p.single_acting <= 0.0:
        out[N2], out[U2] = net_2, h_2 + q2 + p2 * p.area_2 * v

    # exhaust and supply
    if p.exhaust_area > 0.0:
        w = orifice(p.exhaust_area, exhaust, t_exhaust, ambient, room, ELLIPSE, 0.3, 0.5, 0.0, p)
        out[NX] = out_1 + out_2 - w
        out[UX] = back_1 + back_2 - cp * w * (t_exhaust if w > 0.0 else room)
    drawn = in_1 + in_2
    if p.tank_volume > 0.0:
        feed = max(p.tank_feed * (p.supply - supply), 0.0)
        out[NT] = feed - drawn
        out[UT] = cp * (feed * room - drawn * t_supply) + p.tank_heat * (room - t_supply)
    elif p.regulator_droop > 0.0:
        target = p.supply - p.regulator_droop * drawn
        if p.regulator_overshoot > 0.0:  # second order, damped by 1 - overshoot
            omega = 1.0 / p.regulator_time
            out[REG] = y[REG_V]
            out[REG_V] = omega * omega * (target - y[REG]) - 2.0 * (1.0 - p.regulator_overshoot) * omega * y[REG_V]
        else:
            out[REG] = (target - y[REG]) / p.regulator_time
    spool_rates(y, u, p, out)

    # forces
    gas_force = p1 * p.area_1 - p2 * p.area_2 - ambient * (p.area_1 - p.area_2)
    sliding = level(v, x, p1, p2, y[REST], y[WARM], p)
    dry, out[BRISTLE] = contact(v, y[BRISTLE], sliding, p)
    friction = dry + viscous(v, y[WARM], p) + p.drag * abs(v) * v
    out[REST] = 1.0 - y[REST] * abs(v) / 1e-4
    if p.warm_gain > 0.0:
        out[WARM] = (abs(friction * v) / p.warm_power - y[WARM]) / p.warm_time
    own = gas_force - friction - p.spring * (x - p.spring_rest)
    if x < 0.0:
        own += max(-p.stop_stiffness * x - p.stop_damping * v, 0.0)
    elif x > p.stroke:
        own -= max(p.stop_stiffness * (x - p.stroke) + p.stop_damping * v, 0.0)
    weight = p.gravity * (math.cos(y[Q]) if p.lever > 0.0 else 1.0)
    load = -weight - p.damping * y[QD]
    out[Q] = y[QD]
    if soft:
        stretch = x - rod
        half = 0.5 * p.mount_gap
        through = 0.0
        if abs(stretch) > half:
            through = p.mount_stiffness * (stretch - half if stretch > 0.0 else stretch + half)
            through += p.mount_damping * (v - slope * y[QD])
            if through * stretch < 0.0 and p.mount_gap > 0.0:
                through = 0.0
        out[X], out[V] = v, (own - through) / p.piston_mass
        out[QD] = (slope * through + load) / p.inertia if p.led <= 0.0 else 0.0
    elif p.led > 0.0:
        through = own - p.piston_mass * y[LED]
    else:
        rate = p.piston_mass * bend * y[QD] * y[QD]
        out[QD] = (slope * (own - rate) + load) / (p.inertia + p.piston_mass * slope * slope)
        through = own - p.piston_mass * (slope * out[QD] + bend * y[QD] * y[QD])
        out[X], out[V] = 0.0, 0.0
    said[P1], said[P2], said[PV1], said[PV2] = p1, p2, pv1, pv2
    said[SUPPLY], said[EXHAUST], said[FORCE], said[T1], said[T2] = supply, exhaust, through, t1, t2
    said[FRICTION], said[DRAWN], said[PISTON], said[SPEED], said[GAS] = friction, drawn, x, v, gas_force


@kernel
def at_rest(y, q, p1, p2, p):
    """Write the state at rest at joint position q, all gas at room temperature."""
    for i in range(STATES):
        y[i] = 0.0
    k, gas = p.heat_ratio, p.gas_constant
    x, _, _ = transmission(q, p)
    y[Q], y[X] = q, x
    cv = gas / (k - 1.0)
    rt = gas * p.room
    y[N1] = p1 * (p.dead_1 + p.area_1 * x) / rt
    y[U1] = y[N1] * cv * p.room
    y[N2] = p2 * (p.dead_2 + p.area_2 * (p.stroke - x)) / rt
    y[U2] = y[N2] * cv * p.room
    y[NX] = p.ambient * p.exhaust_volume / rt
    y[UX] = y[NX] * cv * p.room
    y[NT] = p.supply * p.tank_volume / rt
    y[UT] = y[NT] * cv * p.room
    y[REG] = p.supply
    y[W1] = p.room
    y[W2] = p.room
    if p.hose_kind > 0.0:
        volume = p.hose_volume if p.hose_kind == 1.0 else 0.25 * math.pi * p.hose_bore**2 * p.hose_length / CELLS
        for i in range(CELLS):
            y[LINE_1 + 2 * i] = p1 * volume / rt
            y[LINE_1 + 2 * i + 1] = y[LINE_1 + 2 * i] * cv * p.room
            y[LINE_2 + 2 * i] = p2 * volume / rt
            y[LINE_2 + 2 * i + 1] = y[LINE_2 + 2 * i] * cv * p.room
