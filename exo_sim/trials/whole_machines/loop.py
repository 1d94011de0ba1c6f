"""A whole machine in time: the strong-stability-preserving Runge-Kutta scheme of third order (Shu and Osher 1988) in fixed steps, and
the machine's own controller.
"""

from __future__ import annotations

import math

import numpy as np

from exo_sim.trials.whole_machines.compiled import kernel
from exo_sim.trials.whole_machines.plant import (
    EXHAUST,
    FORCE,
    GAS,
    LED,
    P1,
    P2,
    PISTON,
    PV1,
    PV2,
    QD,
    SAID,
    SPEED,
    SPOOL,
    STATES,
    SUPPLY,
    T1,
    T2,
    Q,
    behind_play,
    rates,
)

#: Columns of the log, one row a sub-sample.
LOG = ("time", "position", "velocity", "command", "pressure_1", "pressure_2", "valve_1", "valve_2", "supply", "exhaust", "force",
       "temperature_1", "temperature_2", "piston", "piston_speed", "gas_force")  # fmt: skip
_SAID = (P1, P2, PV1, PV2, SUPPLY, EXHAUST, FORCE, T1, T2, PISTON, SPEED, GAS)
#: How a command is made: as fed; position control; impedance control; switching position control; as fed with a pull to the goal; as fed,
#: turned round where it would lead further from the goal than is allowed.
FED, POSITION, FORCES, SWITCHED, PULLED, TURNED = range(6)
#: Gains: position, velocity and force damping of the position control; force and its integral, stiffness of the impedance control (whose
#: place is given as its speed); pull; band of the switching control, its lead [s]; how far a turned command may lead.
GAINS = 10
MEMO = 1


@kernel
def rk3(y, place, u, h, p, a, y1, said):
    """Advance the state by h in place."""
    rates(y, place, u, p, a, said)
    for j in range(STATES):
        y1[j] = y[j] + h * a[j]
    rates(y1, place, u, p, a, said)
    for j in range(STATES):
        y1[j] = 0.75 * y[j] + 0.25 * (y1[j] + h * a[j])
    rates(y1, place, u, p, a, said)
    for j in range(STATES):
        y[j] = (y[j] + 2.0 * (y1[j] + h * a[j])) / 3.0


@kernel
def command(mode, goal, speed, feed, seen, rate, force, slow_force, integral, last, gains):
    """Return the command that the controller of this mode gives, before its limits."""
    if mode == FED:
        return feed
    if mode == POSITION:
        return gains[0] * (goal - seen) + gains[1] * (speed - rate) - gains[2] * (force - slow_force) + feed
    if mode == FORCES:
        return gains[3] * (goal + gains[5] * (speed - seen) - force) + gains[4] * integral + feed
    if mode == SWITCHED:
        off = goal - seen - gains[8] * rate
        if abs(off) > gains[7]:
            return 1.0 if off > 0.0 else -1.0
        return 0.0 if abs(off) < 0.4 * gains[7] else last
    if mode == TURNED:
        ahead = seen + gains[8] * rate - goal
        return -feed if feed * ahead > 0.0 and abs(ahead) > gains[9] else feed
    return feed + gains[6] * (goal - seen)


@kernel
def run(record, y, memo, steps, sub, dt, mode, goal, speed, feed, gains, noise, log, states, resets, led):
    """Advance a machine from tick to tick of its controller.

    Args:
        record: `Machine.packed()`.
        y: State at the first tick, changed in place, shape (STATES,).
        memo: Memory of the valve's play, shape (MEMO,).
        steps: Integration steps in each row of the log, shape (n * sub,).
        sub: Rows of the log between two ticks.
        dt: Integration step [s].
        mode, goal, speed, feed: What the controller does at each tick, shape (n,).
        gains: See `GAINS`.
        noise: What the controller's own position sensor adds, shape (n,).
        log: Written, shape (n * sub, len(LOG)).
        states: State and memory at each tick, shape (n, STATES + MEMO): written, or read where `resets` says so; may have no rows.
        resets: 1 where the state is set to `states` before the tick, -1 where nothing is simulated until the next reset, shape (n,).
        led: Position, speed and acceleration of the load in each row of the log, where a wearer leads it, shape (n * sub, 3) or (0, 3).
    """
    p = record[0]
    n = mode.shape[0]
    a, y1, said = np.zeros(STATES), np.zeros(STATES), np.zeros(SAID)
    t, arrived = 0.0, 0
    rate, last_seen, slow_force, integral, last = 0.0, y[Q], 0.0, 0.0, 0.0
    rates(y, 0.0, 0.0, p, a, said)
    for i in range(n):
        period = 0.0
        for j in range(sub):
            period += steps[i * sub + j] * dt
        log[i * sub, 0] = t
        if resets[i] == 1:
            for j in range(STATES):
                y[j] = states[i, j]
            for j in range(MEMO):
                memo[j] = states[i, STATES + j]
            while arrived > 0 and log[arrived * sub, 0] > t - p.delay:
                arrived -= 1
        elif resets[i] == 0 and states.shape[0] > 0:
            for j in range(STATES):
                states[i, j] = y[j]
            for j in range(MEMO):
                states[i, STATES + j] = memo[j]
        if led.shape[0] > 0:
            y[Q], y[QD], y[LED] = led[i * sub, 0], led[i * sub, 1], led[i * sub, 2]
        rates(y, 0.0, 0.0, p, a, said)
        seen = y[Q] + noise[i]
        if i > 0:
            rate += (1.0 - math.exp(-period / 0.006)) * ((seen - last_seen) / period - rate)
            slow_force += (1.0 - math.exp(-period / 0.15)) * (said[GAS] - slow_force)
        else:
            slow_force = said[GAS]
        last_seen = seen
        u = command(mode[i], goal[i], speed[i], feed[i], seen, rate, said[GAS], slow_force, integral, last, gains)
        if mode[i] == FORCES and abs(u) < 1.0:
            integral += (goal[i] + gains[5] * (speed[i] - seen) - said[GAS]) * period
        elif mode[i] != FORCES:
            integral = 0.0
        u = math.floor(min(max(u, -1.0), 1.0) * 2047.0 + 0.5) / 2047.0  # a 12-bit output card
        last = u
        for j in range(sub):
            row = i * sub + j
            log[row, 0] = t
            log[row, 3] = u
            if resets[i] < 0:
                t += steps[row] * dt
                continue
            if led.shape[0] > 0:
                y[Q], y[QD], y[LED] = led[row, 0], led[row, 1], led[row, 2]
            rates(y, memo[0], u, p, a, said)
            log[row, 1] = y[Q]
            log[row, 2] = y[QD]
            for m in range(len(_SAID)):
                log[row, 4 + m] = said[_SAID[m]]
            for _ in range(steps[row]):
                while arrived < i and log[(arrived + 1) * sub, 0] <= t - p.delay:
                    arrived += 1
                commanded = log[arrived * sub, 3]
                if p.spool_frequency <= 0.0 and p.lag <= 0.0:
                    y[SPOOL] = commanded
                rk3(y, memo[0], commanded, dt, p, a, y1, said)
                memo[0] = behind_play(y[SPOOL], memo[0], p.play)
                t += dt
