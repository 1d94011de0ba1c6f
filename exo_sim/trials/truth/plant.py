"""The true machine in motion: mass and temperature of every gas volume, bristles for friction, fixed fine steps.

Every volume carries (mass, temperature); flow follows the ellipse of ISO 6358 whose choked branch has the capacity
of the
throat area; friction is LuGre, its bristle advanced implicitly; everything else by the explicit midpoint rule.
All compiled code of the bench lives in this one file, because numba's cache does not see changes in other files.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

# places in the state vector
XP, VP, XL, VL, M1, T1, M2, T2, TANK, MX, TX, ML1, TL1, ML2, TL2, W1, W2, Q1, Q2, SPOOL, SPOOL_V, REGULATED = range(22)
STATES = 22
#: Columns of the log: time, position of the load, its velocity, both pressures as the sensors' place sees them, at the
#: chamber and at the valve end of the hose, temperatures, supply, exhaust, rod force, command, piston position.
LOG = ("time", "position", "velocity", "pressure_1", "pressure_2", "line_1", "line_2", "temperature_1", "temperature_2",
       "supply", "exhaust", "force", "command", "piston")  # fmt: skip


@njit(cache=True, nogil=True)
def mass_flow(area, p_a, t_a, p_b, t_b, ratio, zone, k, gas):
    """Return the mass flow from a to b [kg/s] through an effective throat area [m^2]; negative when it runs back."""
    if p_a >= p_b:
        up, down, temperature, sign = p_a, p_b, t_a, 1.0
    else:
        up, down, temperature, sign = p_b, p_a, t_b, -1.0
    if area <= 0.0:
        return 0.0
    exponent = (k + 1.0) / (2.0 * (k - 1.0))
    choked = area * up * math.sqrt(k / (gas * temperature)) * (2.0 / (k + 1.0)) ** exponent
    r = down / up
    if r <= ratio:
        return sign * choked
    s = (r - ratio) / (1.0 - ratio)
    inside = (1.0 - s) * (1.0 + s)
    # straight line near equal pressures, the ellipse elsewhere
    return sign * choked * inside / math.sqrt(math.sqrt(inside * inside + zone * zone))


@njit(cache=True, nogil=True)
def porous_flow(difference, laminar, inertial):
    """Return w [kg/s] with difference = w/laminar + inertial w^2, for the difference of squared pressures [Pa^2]."""
    if laminar <= 0.0:
        return 0.0
    size = abs(difference)
    if inertial <= 0.0:
        return difference * laminar
    w = 2.0 * size / (1.0 / laminar + math.sqrt(1.0 / laminar**2 + 4.0 * inertial * size))
    return w if difference > 0 else -w


@njit(cache=True, nogil=True)
def friction_level(v, p1, p2, rest, p):
    """Return the steady dry friction [N] at this velocity, chamber pressures and time at rest."""
    level = p.coulomb + p.dry_friction + p.pressure_friction * (p1 + p2 - 2.0 * p.ambient_pressure)
    level += p.forward if v >= 0.0 else p.backward
    static = level
    if p.stribeck_breakaway > level:
        static = p.stribeck_breakaway
    if p.dwell_growth > 0.0:
        static += p.dwell_growth * math.log10(1.0 + rest / 0.1)
    speed = p.stribeck_velocity if p.stribeck_velocity > 0.0 else 5e-3
    return level + (static - level) * math.exp(-((v / speed) ** 2))


@njit(cache=True, nogil=True)
def valve_areas(u, p):
    """Return the four path areas: supply-1, 1-exhaust, supply-2, 2-exhaust, for a spool at u."""
    u = u + p.offset
    size = abs(u)
    opening = (size - p.deadband) / (1.0 - p.deadband)
    opening = 0.0 if opening < 0.0 else (1.0 if opening > 1.0 else opening)
    if p.curve_exponent != 1.0:
        opening = opening**p.curve_exponent
    full = opening * p.valve_area
    leak = p.null_leak
    if u > 0.0:
        return full + leak, leak, leak, full * p.exhaust_ratio + leak
    return leak, full * p.exhaust_ratio + leak, full + leak, leak


@njit(cache=True, nogil=True)
def through_both(a, b, p_up, t_up, p_down, t_down, ratio, zone, k, gas):
    """Return the flow through two restrictions behind each other, by the pressure between them at which both pass the same."""
    low, high = p_down, p_up
    for _ in range(50):
        middle = 0.5 * (low + high)
        first = mass_flow(a, p_up, t_up, middle, t_up, ratio, zone, k, gas)
        if first > mass_flow(b, middle, t_up, p_down, t_down, ratio, zone, k, gas):
            low = middle
        else:
            high = middle
    return mass_flow(a, p_up, t_up, 0.5 * (low + high), t_up, ratio, zone, k, gas)


@njit(cache=True, nogil=True)
def gas_rates(mass, temperature, volume, volume_rate, net, enthalpy, heat, gas, cv):
    """Return dm/dt and dT/dt of one volume; `net` [kg/s] and `enthalpy` [W] are what flows in."""
    pressure = mass * gas * temperature / volume
    return net, (enthalpy + heat - pressure * volume_rate - net * cv * temperature) / (mass * cv)


@njit(cache=True, nogil=True)
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
    if p.cushion_area > 0.0:
        if x < p.cushion_length and out_1 > 0.0:
            out_1 = through_both(p.cushion_area, e1, end_1, end_t1, exhaust, t_exhaust, b, zone, k, gas)
        if p.stroke - x < p.cushion_length and out_2 > 0.0:
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


@njit(cache=True, nogil=True)
def at_rest(x, p1, p2, p):
    """Return the state at rest at piston position x with both chambers at ambient temperature, shape (STATES,)."""
    y = np.zeros(STATES)
    temperature = p.ambient_temperature
    rt = p.gas_constant * temperature
    y[XP] = x
    y[XL] = x
    y[M1] = p1 * (p.dead_1 + p.area_1 * x) / rt
    y[M2] = p2 * (p.dead_2 + p.area_2 * (p.stroke - x)) / rt
    y[T1] = y[T2] = y[TX] = y[TL1] = y[TL2] = y[W1] = y[W2] = temperature
    y[TANK] = p.supply_pressure
    y[REGULATED] = p.supply_pressure
    y[MX] = p.ambient_pressure * p.exhaust_volume / rt
    y[ML1] = p1 * p.line_volume / rt
    y[ML2] = p2 * p.line_volume / rt
    return y


@njit(cache=True, nogil=True)
def follow(y, bristle, wanted, dt, p):
    """Move the spool for one step towards the command; return what is left of it behind the valve's play."""
    if p.spool_frequency > 0.0:
        w = 2.0 * math.pi * p.spool_frequency
        y[SPOOL_V] += dt * (w * w * (wanted - y[SPOOL]) - 2.0 * p.spool_damping * w * y[SPOOL_V])
        moved = y[SPOOL_V] * dt
    elif p.lag > 0.0:
        moved = (1.0 - math.exp(-dt / p.lag)) * (wanted - y[SPOOL])
    else:
        moved = wanted - y[SPOOL]
    if p.rate_limit > 0.0:
        most = p.rate_limit * dt
        moved = most if moved > most else (-most if moved < -most else moved)
    y[SPOOL] += moved
    if p.hysteresis <= 0.0:
        return y[SPOOL]
    half = 0.5 * p.hysteresis
    if y[SPOOL] - bristle[2] > half:
        bristle[2] = y[SPOOL] - half
    elif y[SPOOL] - bristle[2] < -half:
        bristle[2] = y[SPOOL] + half
    return bristle[2]


@njit(cache=True, nogil=True)
def dry_friction(y, bristle, dt, p):
    """Advance the bristles for one step; return their force [N]."""
    v = y[VP]
    p1 = y[M1] * p.gas_constant * y[T1] / (p.dead_1 + p.area_1 * y[XP])
    p2 = y[M2] * p.gas_constant * y[T2] / (p.dead_2 + p.area_2 * (p.stroke - y[XP]))
    bristle[1] = bristle[1] + dt if abs(v) < 1e-3 else 0.0
    level = friction_level(v, p1, p2, bristle[1], p)
    if p.bump_force > 0.0:
        level += p.bump_force * math.exp(-(((y[XP] - p.bump_place) / p.bump_width) ** 2))
    if level <= 1e-9:
        return 0.0
    z = (bristle[0] + v * dt) / (1.0 + abs(v) * dt * p.bristle_stiffness / level)
    damping = p.bristle_damping * math.exp(-((v / 0.02) ** 2))
    force = p.bristle_stiffness * z + damping * (z - bristle[0]) / dt
    bristle[0] = z
    return force


@njit(cache=True, nogil=True)
def regulate(y, bristle, flow, dt, p):
    """Move the regulator for one step: droop with flow, a play of its hysteresis, then a lag."""
    if p.regulator_droop <= 0.0 and p.regulator_hysteresis <= 0.0:
        return
    target = p.supply_pressure - p.regulator_droop * flow
    half = 0.5 * p.regulator_hysteresis
    held = bristle[3] if bristle[3] != 0.0 else p.supply_pressure
    if target - held > half:
        held = target - half
    elif target - held < -half:
        held = target + half
    bristle[3] = held
    rate = 1.0 - math.exp(-dt / p.regulator_time) if p.regulator_time > 0.0 else 1.0
    y[REGULATED] += rate * (held - y[REGULATED])


@njit(cache=True, nogil=True)
def run(record, y, bristle, start, ticks, dt, mode, goal, speed, feed, gains, noise, log, states):
    """Advance the machine from tick to tick.

    Args:
        record: `Machine.packed()`.
        y: State at the first tick, shape (STATES,); holds the last state afterwards.
        bristle: (deflection [m], seconds at rest, play of the valve, play of the regulator), changed in place,
        shape (4,).
        start: Time of the first tick [s].
        ticks: Integration steps between a tick and the next, shape (n,).
        dt: Integration step [s].
        mode: What makes the command at each tick: 0 `feed` as it is, 1 position control towards `goal`, 2 `feed`
        plus a pull
            towards `goal`, shape (n,).
        goal, speed, feed: Wanted position [m] and velocity [m/s], command given in advance, shape (n,).
        gains: Position [1/m], velocity [s/m] and pressure [1/Pa] gain of the bench's own controller, and the pull
        of mode 2.
        noise: What the controller's position sensor adds [m], shape (n,).
        log: Written, shape (n, len(LOG)).
        states: Written where it has rows: full state, bristle and time at each tick, shape (n or 0, STATES + 5).
    """
    p = record[0]
    n = ticks.shape[0]
    a, b, middle = np.zeros(STATES), np.zeros(STATES), np.empty(STATES)
    t = start
    filtered, last = 0.0, y[XL] if p.drive_stiffness > 0.0 else y[XP]
    slow = 0.0
    longest = round(p.delay / dt)
    line = np.zeros(longest + 1)
    for i in range(longest + 1):
        line[i] = feed[0] if mode[0] == 0 else 0.0
    head = 0
    for i in range(n):
        supply_flow, force, supply, exhaust = rates(y, y[SPOOL], 0.0, t, p, a)
        x_seen = (y[XL] if p.drive_stiffness > 0.0 else y[XP]) + noise[i]
        gas = p.gas_constant
        p1 = y[M1] * gas * y[T1] / (p.dead_1 + p.area_1 * y[XP])
        p2 = y[M2] * gas * y[T2] / (p.dead_2 + p.area_2 * (p.stroke - y[XP]))
        if p.double_acting <= 0.0:
            p2 = p.ambient_pressure
        period = ticks[i] * dt
        filtered += (1.0 - math.exp(-period / 0.004)) * ((x_seen - last) / period - filtered) if i > 0 else 0.0
        last = x_seen
        if i == 0:
            slow = force
        slow += (1.0 - math.exp(-period / 0.15)) * (force - slow)
        if mode[i] == 0:
            u = feed[i]
        else:
            error = goal[i] - (y[XL] if p.drive_stiffness > 0.0 else y[XP]) - noise[i]
            if mode[i] == 1:
                u = gains[0] * error + gains[1] * (speed[i] - filtered) - gains[2] * (force - slow) + feed[i]
            else:
                u = feed[i] + gains[3] * error
        u = 1.0 if u > 1.0 else (-1.0 if u < -1.0 else u)
        u = round(u * 2048.0) / 2048.0  # a 12-bit output card
        joint = y[XL] if p.drive_stiffness > 0.0 else y[XP]
        log[i, 0] = t
        log[i, 1] = joint
        log[i, 2] = y[VL] if p.drive_stiffness > 0.0 else y[VP]
        log[i, 3] = p1
        log[i, 4] = p2
        if p.line_area > 0.0 or p.line_inertance > 0.0:
            log[i, 5] = y[ML1] * gas * y[TL1] / p.line_volume
            log[i, 6] = y[ML2] * gas * y[TL2] / p.line_volume
        else:
            log[i, 5] = p1
            log[i, 6] = p2
        log[i, 7] = y[T1]
        log[i, 8] = y[T2]
        log[i, 9] = supply
        log[i, 10] = exhaust
        log[i, 11] = force
        log[i, 12] = u
        log[i, 13] = y[XP]
        if states.shape[0] > 0:
            states[i, :STATES] = y
            states[i, STATES : STATES + 4] = bristle
            states[i, STATES + 4] = t
        for _ in range(ticks[i]):
            line[head] = u
            head = head + 1 if head < longest else 0
            wanted = line[head] if p.delay > 0.0 else u
            spool = follow(y, bristle, wanted, dt, p)
            dry = dry_friction(y, bristle, dt, p)
            supply_flow, force, supply, exhaust = rates(y, spool, dry, t, p, a)
            for j in range(STATES):
                middle[j] = y[j] + 0.5 * dt * a[j]
            supply_flow, force, supply, exhaust = rates(middle, spool, dry, t + 0.5 * dt, p, b)
            for j in range(STATES):
                y[j] += dt * b[j]
            regulate(y, bristle, supply_flow, dt, p)
            t += dt


@njit(cache=True, nogil=True)
def run_led(record, y, bristle, ticks, dt, x, v, closed, goal, gains, log):
    """Advance a cylinder whose far end is led along a motion, its valve closing a loop on force.

    Args:
        record: `Machine.packed()` with a unit mass and no load; rigid, or with a drive between piston and joint.
        y, bristle, ticks, dt: As in `run`.
        x, v: Place [m] and velocity [m/s] of the joint's end at each tick, shape (n + 1,).
        closed: 1 where the valve is commanded closed, 2 where `goal` is the command itself, shape (n,).
        goal: Gas force wanted [N], or a command, shape (n,).
        gains: Command per newton, per newton second, and per metre a second.
        log: Written, shape (n, len(LOG)); `force` is what a load cell between rod and joint feels.
    """
    p = record[0]
    a, b, middle = np.zeros(STATES), np.zeros(STATES), np.empty(STATES)
    coupled = p.drive_stiffness > 0.0
    place, rate = (XL, VL) if coupled else (XP, VP)
    gas = p.gas_constant
    t, integral = 0.0, 0.0
    longest = round(p.delay / dt)
    line = np.zeros(longest + 1)
    head = 0
    y[place], y[rate] = x[0], v[0]
    spool, dry, cell = 0.0, 0.0, 0.0
    for i in range(ticks.shape[0]):
        span = ticks[i] * dt
        y[place], y[rate] = x[i], v[i]
        supply_flow, force, supply, exhaust = rates(y, spool, dry, t, p, a)
        cell = p.drive_stiffness * (y[XP] - y[XL]) if coupled else a[VP] * p.load_mass
        error = goal[i] - force
        u = gains[0] * error + gains[1] * integral + gains[2] * v[i]
        if closed[i] == 2:
            u = goal[i]
        elif closed[i] == 1:
            u, integral = 0.0, 0.0
        elif abs(u) < 1.0:
            integral += error * span
        u = 1.0 if u > 1.0 else (-1.0 if u < -1.0 else u)
        u = round(u * 2048.0) / 2048.0
        p1 = y[M1] * gas * y[T1] / (p.dead_1 + p.area_1 * y[XP])
        p2 = y[M2] * gas * y[T2] / (p.dead_2 + p.area_2 * (p.stroke - y[XP]))
        lines = p.line_area > 0.0 or p.line_inertance > 0.0
        log[i, 0], log[i, 1], log[i, 2], log[i, 3], log[i, 4] = t, x[i], v[i], p1, p2
        log[i, 5] = y[ML1] * gas * y[TL1] / p.line_volume if lines else p1
        log[i, 6] = y[ML2] * gas * y[TL2] / p.line_volume if lines else p2
        log[i, 7], log[i, 8], log[i, 9], log[i, 10] = y[T1], y[T2], supply, exhaust
        log[i, 11], log[i, 12], log[i, 13] = cell, u, y[XP]
        for k in range(ticks[i]):
            line[head] = u
            head = head + 1 if head < longest else 0
            spool = follow(y, bristle, line[head] if p.delay > 0.0 else u, dt, p)
            for half in range(2):
                # cubic between the ticks
                s = (k + 0.5 * half) / ticks[i]
                h1, h2 = s * s * (3.0 - 2.0 * s), s * (1.0 - s) * (1.0 - s) * span
                h3, d = -s * s * (1.0 - s) * span, 6.0 * s * (1.0 - s) / span
                here = x[i] + h1 * (x[i + 1] - x[i]) + h2 * v[i] + h3 * v[i + 1]
                speed = d * (x[i + 1] - x[i]) + (1.0 - s) * (1.0 - 3.0 * s) * v[i] + s * (3.0 * s - 2.0) * v[i + 1]
                if half == 0:
                    y[place], y[rate] = here, speed
                    dry = dry_friction(y, bristle, dt, p)
                    rates(y, spool, dry, t, p, a)
                    for j in range(STATES):
                        middle[j] = y[j] + 0.5 * dt * a[j]
                else:
                    middle[place], middle[rate] = here, speed
                    supply_flow, force, supply, exhaust = rates(middle, spool, dry, t + 0.5 * dt, p, b)
            for j in range(STATES):
                y[j] += dt * b[j]
            regulate(y, bristle, supply_flow, dt, p)
            t += dt
