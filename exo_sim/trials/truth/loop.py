"""The true machine in motion, from tick to tick: fixed fine steps of the explicit midpoint rule, under a bench's controller or led."""

from __future__ import annotations

import math

import numpy as np

from exo_sim.trials.truth.compiled import kernel
from exo_sim.trials.truth.friction import dry_friction
from exo_sim.trials.truth.plant import rates
from exo_sim.trials.truth.state import M1, M2, ML1, ML2, SPOOL, STATES, T1, T2, TL1, TL2, VL, VP, XL, XP
from exo_sim.trials.truth.valve import follow, regulate


@kernel
def run(record, y, bristle, start, ticks, dt, mode, goal, speed, feed, gains, noise, log, states):
    """Advance the machine from tick to tick.

    Args:
        record: `Machine.packed()`.
        y: State at the first tick, shape (STATES,); holds the last state afterwards.
        bristle: (deflection [m], seconds at rest, play of the valve, play of the regulator), changed in place, shape (4,).
        start: Time of the first tick [s].
        ticks: Integration steps between a tick and the next, shape (n,).
        dt: Integration step [s].
        mode: What makes the command at each tick: 0 `feed` as it is, 1 position control towards `goal`, 2 `feed` plus a pull
            towards `goal`, shape (n,).
        goal, speed, feed: Wanted position [m] and velocity [m/s], command given in advance, shape (n,).
        gains: Position [1/m], velocity [s/m] and pressure [1/Pa] gain of the bench's own controller, and the pull of mode 2.
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


@kernel
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
