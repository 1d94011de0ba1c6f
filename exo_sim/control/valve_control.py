"""How a valve gets a force: plain PI, or the paper's pressure dynamics inverted. Both have the same limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exo_sim.physics.compiled import kernel
from exo_sim.physics.nozzle import choked_flow, flow

CONTROLLERS = ("model", "pi")
OFF, PI, MODEL, GIVEN = 0, 1, 2, 3


@dataclass(frozen=True)
class ValveGains:
    """Settings of both controllers.

    Attributes:
        proportional: PI: opening for each newton of error, times the piston area in square metres and the supply's
            gauge pressure [1].
        integral: PI: the same for error over time [1/s].
        closing_time: Model-based: time constant with which a force error is to close [s].
        preview: How far ahead the demand is read [s]: the lag of the force loop.
    """

    proportional: float = 8.0
    integral: float = 40.0
    closing_time: float = 0.006
    preview: float = 0.0


@kernel
def pi(error: float, scale: float, integral: float, proportional: float, rate: float, dt: float) -> tuple[float, float]:
    """Return valve command and the integral's new value.

    Args:
        error: Force wanted less force [N].
        scale: Largest force of the cylinder [N]; gains are relative to it.
        integral: Held integral, as an opening.
        proportional: Opening for an error of `scale`.
        rate: Opening a second for an error of `scale`.
        dt: [s].
    """
    relative = error / scale
    grown = integral + rate * relative * dt
    command = proportional * relative + grown
    if command > 1.0:
        return 1.0, min(integral, grown)
    if command < -1.0:
        return -1.0, max(integral, grown)
    return command, grown


@kernel
def invert(
    wanted: float, v: float, p_1: float, t_1: float, p_2: float, t_2: float, v_1: float, v_2: float, area_1: float,
    area_2: float, valve_area: float, p_s: float, t_s: float, p_e: float, t_e: float, k: float, r: float,
) -> float:  # fmt: skip
    """Return the opening for which the rod force changes at a wanted rate (corrected equation 34, each chamber by itself).

    dF/dt = A1 dP1/dt - A2 dP2/dt with dPi/dt = k/Vi (R T mdot - Pi dVi/dt). The valve's gain is the flow of its two
    open paths at full command, choked or not as they stand.

    Args:
        wanted: Rate of the rod force [N/s].
        v: Piston speed [m/s].
        p_1, t_1, v_1, p_2, t_2, v_2: Pressure [Pa], temperature [K], volume [m^3] of the chambers.
        area_1, area_2: Piston areas [m^2].
        valve_area: Of one path at full command [m^2].
        p_s, t_s, p_e, t_e: Supply and exhaust.
        k, r: The gas.
    """
    by_motion = -k * (p_1 * area_1 * area_1 / v_1 + p_2 * area_2 * area_2 / v_2) * v
    by_valve = wanted - by_motion
    if by_valve >= 0.0:
        into = flow(valve_area, p_s, t_s, p_1, t_1, k, r)
        out = flow(valve_area, p_2, t_2, p_e, t_e, k, r)
        gain = k * r * (area_1 / v_1 * max(into, 0.0) * t_s + area_2 / v_2 * max(out, 0.0) * t_2)
        least = _least_gain(area_1, v_1, area_2, v_2, valve_area, p_s, t_s, k, r)
        return by_valve / max(gain, least)
    into = flow(valve_area, p_s, t_s, p_2, t_2, k, r)
    out = flow(valve_area, p_1, t_1, p_e, t_e, k, r)
    gain = k * r * (area_2 / v_2 * max(into, 0.0) * t_s + area_1 / v_1 * max(out, 0.0) * t_1)
    least = _least_gain(area_1, v_1, area_2, v_2, valve_area, p_s, t_s, k, r)
    return by_valve / max(gain, least)


@kernel
def _least_gain(
    area_1: float, v_1: float, area_2: float, v_2: float, valve_area: float, p_s: float, t_s: float, k: float, r: float
) -> float:
    """Return a twentieth of the gain with both paths choked from the supply: below it, more opening would not help."""
    choked = choked_flow(valve_area, p_s, t_s, k, r)
    return 0.05 * k * r * t_s * choked * (area_1 / v_1 + area_2 / v_2)


@kernel
def force_limits(area_1: float, area_2: float, p_s: float, p_e: float, atmosphere: float) -> tuple[float, float]:
    """Return the least and the largest rod force that the supply can hold [N]."""
    on_rod = atmosphere * (area_1 - area_2)
    return p_e * area_1 - p_s * area_2 - on_rod, p_s * area_1 - p_e * area_2 - on_rod


@kernel
def spring_pull(c, x):
    """Return what the springs beside a piston take off the gas's force on the rod [N], the piston at x [m]."""
    return c.return_spring.stiffness * (x - c.return_spring.rest)


def controller_code(name: str) -> int:
    """Return the number by which compiled code knows a controller."""
    return {"off": OFF, "pi": PI, "model": MODEL, "given": GIVEN}[name]


def largest_forces(area_1: np.ndarray, area_2: np.ndarray, p_s: float, p_e: float, atmosphere: float) -> np.ndarray:
    """Return `force_limits` of several cylinders, shape (n, 2)."""
    return np.array([force_limits(a, b, p_s, p_e, atmosphere) for a, b in zip(area_1, area_2)])
