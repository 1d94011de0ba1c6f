"""Flows of the true machine: the ellipse of ISO 6358 whose choked branch has the capacity of the throat area, pores, a gas volume."""

from __future__ import annotations

import math

from exo_sim.trials.truth.compiled import kernel


@kernel
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


@kernel
def porous_flow(difference, laminar, inertial):
    """Return w [kg/s] with difference = w/laminar + inertial w^2, for the difference of squared pressures [Pa^2]."""
    if laminar <= 0.0:
        return 0.0
    size = abs(difference)
    if inertial <= 0.0:
        return difference * laminar
    w = 2.0 * size / (1.0 / laminar + math.sqrt(1.0 / laminar**2 + 4.0 * inertial * size))
    return w if difference > 0 else -w


@kernel
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


@kernel
def gas_rates(mass, temperature, volume, volume_rate, net, enthalpy, heat, gas, cv):
    """Return dm/dt and dT/dt of one volume; `net` [kg/s] and `enthalpy` [W] are what flows in."""
    pressure = mass * gas * temperature / volume
    return net, (enthalpy + heat - pressure * volume_rate - net * cv * temperature) / (mass * cv)
