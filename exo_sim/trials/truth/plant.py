"""What changes the true machine's state: mass and temperature of every gas volume, forces on piston and load."""

from __future__ import annotations

import math

from exo_sim.trials.truth.compiled import kernel
from exo_sim.trials.truth.flows import gas_rates, mass_flow, porous_flow, through_both
from exo_sim.trials.truth.state import (
    M1,
    M2,
    ML1,
    ML2,
    MX,
    Q1,
    Q2,
    REGULATED,
    STATES,
    T1,
    T2,
    TANK,
    TL1,
    TL2,
    TX,
    VL,
    VP,
    W1,
    W2,
    XL,
    XP,
)  # fmt: skip
from exo_sim.trials.truth.valve import valve_areas


@kernel
def rates(y, u, dry, t, p, out):
    """Write the time derivative of the state; returns (supply flow, rod force, supply pressure, exhaust pressure)."""
    gas, k = p.gas_constant, p.heat_ratio
    cv = gas / (k - 1.0)
    cp = k * cv
    zone = p.laminar_zone
    for i in range(STATES):
        out[i] = 0.0
    coupled = p.drive_stiffness > 0.0
    x, v = y[XP], y[VP]
    volume_1 = p.dead_1 + p.area_1 * x
    volume_2 = p.dead_2 + p.area_2 * (p.stroke - x)
    lines = p.line_area > 0.0 or p.line_inertance > 0.0
    p1 = y[M1] * gas * y[T1] / volume_1
    p2 = y[M2] * gas * y[T2] / volume_2
    ambient, t_ambient = p.ambient_pressure, p.ambient_temperature
    supply = p.supply_pressure
    if p.tank_volume > 0.0:
        supply = y[TANK]
    elif p.regulator_droop > 0.0 or p.regulator_hysteresis > 0.0:
        supply = y[REGULATED]
    t_supply = p.supply_temperature
    exhaust, t_exhaust = ambient, t_ambient
    if p.exhaust_area > 0.0:
        exhaust = y[MX] * gas * y[TX] / p.exhaust_volume
        t_exhaust = y[TX]
    if lines:
        end_1, end_t1 = y[ML1] * gas * y[TL1] / p.line_volume, y[TL1]
        end_2, end_t2 = y[ML2] * gas * y[TL2] / p.line_volume, y[TL2]
    else:
        end_1, end_t1, end_2, end_t2 = p1, y[T1], p2, y[T2]

    s1, e1, s2, e2 = valve_areas(u, p)
    if p.flow_force > 0.0:
        s1 *= 1.0 - p.flow_force * abs(supply - end_1) / 1e6
        s2 *= 1.0 - p.flow_force * abs(supply - end_2) / 1e6
        e1 *= 1.0 - p.flow_force * abs(end_1 - exhaust) / 1e6
        e2 *= 1.0 - p.flow_force * abs(end_2 - exhaust) / 1e6
    b = p.choked_ratio
    in_1 = mass_flow(s1, supply, t_supply, end_1, end_t1, b, zone, k, gas)
    out_1 = mass_flow(e1, end_1, end_t1, exhaust, t_exhaust, b, zone, k, gas)
    in_2 = mass_flow(s2, supply, t_supply, end_2, end_t2, b, zone, k, gas)
    out_2 = mass_flow(e2, end_2, end_t2, exhaust, t_exhaust, b, zone, k, gas)
    # the needle sits in the end cap: a line, where there is one, begins behind it
    cushions_1 = p.cushion_area > 0.0 and x < p.cushion_length
    cushions_2 = p.cushion_area > 0.0 and p.stroke - x < p.cushion_length
    if not lines:
        if cushions_1 and out_1 > 0.0:
            out_1 = through_both(p.cushion_area, e1, end_1, end_t1, exhaust, t_exhaust, b, zone, k, gas)
        if cushions_2 and out_2 > 0.0:
            out_2 = through_both(p.cushion_area, e2, end_2, end_t2, exhaust, t_exhaust, b, zone, k, gas)
    net_1 = in_1 - out_1
    net_2 = in_2 - out_2
    h_1 = cp * (in_1 * (t_supply if in_1 > 0 else end_t1) - out_1 * (end_t1 if out_1 > 0 else t_exhaust))
    h_2 = cp * (in_2 * (t_supply if in_2 > 0 else end_t2) - out_2 * (end_t2 if out_2 > 0 else t_exhaust))
    supply_flow = in_1 + in_2

    if lines:
        if p.line_inertance > 0.0:
            through_1, through_2 = y[Q1], y[Q2]
            out[Q1] = (end_1 - p1) / p.line_inertance - p.line_resistance * y[Q1]
            out[Q2] = (end_2 - p2) / p.line_inertance - p.line_resistance * y[Q2]
        else:
            through_1 = mass_flow(p.line_area, end_1, end_t1, p1, y[T1], p.leak_ratio, zone, k, gas)
            through_2 = mass_flow(p.line_area, end_2, end_t2, p2, y[T2], p.leak_ratio, zone, k, gas)
            needle = p.cushion_area
            if cushions_1 and through_1 < 0.0:
                through_1 = -through_both(needle, p.line_area, p1, y[T1], end_1, end_t1, p.leak_ratio, zone, k, gas)
            if cushions_2 and through_2 < 0.0:
                through_2 = -through_both(needle, p.line_area, p2, y[T2], end_2, end_t2, p.leak_ratio, zone, k, gas)
        carried_1 = cp * through_1 * (end_t1 if through_1 > 0 else y[T1])
        carried_2 = cp * through_2 * (end_t2 if through_2 > 0 else y[T2])
        out[ML1], out[TL1] = gas_rates(
            y[ML1], y[TL1], p.line_volume, 0.0, net_1 - through_1, h_1 - carried_1, 0.0, gas, cv
        )
        out[ML2], out[TL2] = gas_rates(
            y[ML2], y[TL2], p.line_volume, 0.0, net_2 - through_2, h_2 - carried_2, 0.0, gas, cv
        )
        net_1, net_2, h_1, h_2 = through_1, through_2, carried_1, carried_2

    # leaks
    q = mass_flow(p.leak_piston_area, p1, y[T1], p2, y[T2], p.leak_ratio, zone, k, gas)
    q += p.leak_piston_laminar * (p1 * p1 - p2 * p2)
    if p.crack_area > 0.0 and p1 - p2 > p.crack_pressure:
        q += mass_flow(p.crack_area * min(1.0, (p1 - p2 - p.crack_pressure) / 2e4), p1, y[T1], p2, y[T2], p.leak_ratio,
                       zone, k, gas)  # fmt: skip
    net_1 -= q
    net_2 += q
    carried = cp * q * (y[T1] if q > 0 else y[T2])
    h_1 -= carried
    h_2 += carried
    q = mass_flow(p.leak_out_area_1, p1, y[T1], ambient, t_ambient, p.leak_ratio, zone, k, gas)
    q += porous_flow(p1 * p1 - ambient * ambient, p.leak_out_laminar_1, p.leak_out_inertial)
    if p.relief_slope > 0.0 and p1 > p.relief_pressure:
        q += mass_flow(
            p.relief_slope * (p1 - p.relief_pressure), p1, y[T1], ambient, t_ambient, p.leak_ratio, zone, k, gas
        )
    net_1 -= q
    h_1 -= cp * q * (y[T1] if q > 0 else t_ambient)
    q = mass_flow(p.leak_out_area_2, p2, y[T2], ambient, t_ambient, p.leak_ratio, zone, k, gas)
    q += porous_flow(p2 * p2 - ambient * ambient, p.leak_out_laminar_2, p.leak_out_inertial)
    net_2 -= q
    h_2 -= cp * q * (y[T2] if q > 0 else t_ambient)

    # walls
    heat_1, heat_2 = 0.0, 0.0
    if p.heat_conductance > 0.0:
        g_1, g_2 = p.heat_conductance, p.heat_conductance
        if p.heat_eichelberg > 0.0:
            g_1 *= 1.0 + p.heat_eichelberg * (math.sqrt(p1 * y[T1] / (4e5 * 293.15)) - 1.0)
            g_2 *= 1.0 + p.heat_eichelberg * (math.sqrt(p2 * y[T2] / (4e5 * 293.15)) - 1.0)
        heat_1 = g_1 * (y[W1] - y[T1])
        heat_2 = g_2 * (y[W2] - y[T2])
        if p.wall_capacity > 0.0:
            out[W1] = (-heat_1 - p.wall_outside * (y[W1] - t_ambient)) / p.wall_capacity
            out[W2] = (-heat_2 - p.wall_outside * (y[W2] - t_ambient)) / p.wall_capacity
    out[M1], out[T1] = gas_rates(y[M1], y[T1], volume_1, p.area_1 * v, net_1, h_1, heat_1, gas, cv)
    if p.double_acting > 0.0:
        out[M2], out[T2] = gas_rates(y[M2], y[T2], volume_2, -p.area_2 * v, net_2, h_2, heat_2, gas, cv)
    else:
        p2 = ambient
        out[M2] = -y[M2] * p.area_2 * v / volume_2
    if p.exhaust_area > 0.0:
        q = mass_flow(p.exhaust_area, exhaust, t_exhaust, ambient, t_ambient, p.leak_ratio, zone, k, gas)
        h_in = cp * (out_1 * (end_t1 if out_1 > 0 else t_exhaust) + out_2 * (end_t2 if out_2 > 0 else t_exhaust))
        h_in -= cp * q * (t_exhaust if q > 0 else t_ambient)
        out[MX], out[TX] = gas_rates(y[MX], y[TX], p.exhaust_volume, 0.0, out_1 + out_2 - q, h_in, 0.0, gas, cv)
    if p.tank_volume > 0.0:
        feed = p.tank_conductance * (p.supply_pressure - supply)
        out[TANK] = gas * t_supply / p.tank_volume * ((feed if feed > 0.0 else 0.0) - supply_flow)

    # forces
    force = p1 * p.area_1 - p2 * p.area_2 - ambient * (p.area_1 - p.area_2)
    viscous = p.viscous
    if p.warm_extra > 0.0:
        viscous += p.warm_extra * math.exp(-t / p.warm_time)
    own = -dry - viscous * v - p.drag * abs(v) * v - p.extra_stiffness * (x - p.extra_rest)
    if p.cogging_force > 0.0:
        own += p.cogging_force * math.sin(2.0 * math.pi * x / p.cogging_pitch + p.cogging_phase)
    if p.detent_force > 0.0:
        s = (x - p.detent_place) / p.detent_width
        own -= p.detent_force * s * math.exp(0.5 - 0.5 * s * s) if abs(s) < 8.0 else 0.0
    if x < 0.0:
        push = -p.stop_stiffness * x - p.stop_damping * v
        own += push if push > 0.0 else 0.0
    elif x > p.stroke:
        push = p.stop_stiffness * (x - p.stroke) + p.stop_damping * v
        own -= push if push > 0.0 else 0.0
    mass = p.load_mass
    if p.payload_change != 0.0:
        share = (t - p.payload_time) / p.payload_ramp
        mass += p.payload_change * (0.0 if share < 0.0 else (1.0 if share > 1.0 else share))
    joint, joint_v = (y[XL], y[VL]) if coupled else (x, v)
    load = -mass * p.gravity - p.spring_stiffness * (joint - p.spring_rest) - p.damping * joint_v
    out[XP] = v
    if coupled:
        stretch = x - y[XL]
        half = 0.5 * p.drive_gap
        through = 0.0
        if stretch > half:
            through = p.drive_stiffness * (stretch - half) + p.drive_damping * (v - y[VL])
            through = through if through > 0.0 or p.drive_gap == 0.0 else 0.0
        elif stretch < -half:
            through = p.drive_stiffness * (stretch + half) + p.drive_damping * (v - y[VL])
            through = through if through < 0.0 or p.drive_gap == 0.0 else 0.0
        out[VP] = (force + own - through) / p.piston_mass
        out[XL] = y[VL]
        out[VL] = (through + load) / (mass - p.piston_mass)
    else:
        out[VP] = (force + own + load) / mass
        out[XL] = v
        out[VL] = out[VP]
    return supply_flow, force, supply, exhaust
