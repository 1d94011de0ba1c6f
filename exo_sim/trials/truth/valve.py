"""Valve and regulator of the true machine: the spool's way to the command, the paths that it opens, the supply that it is fed from."""

from __future__ import annotations

import math

from exo_sim.trials.truth.compiled import kernel
from exo_sim.trials.truth.state import REGULATED, SPOOL, SPOOL_V


@kernel
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


@kernel
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


@kernel
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
