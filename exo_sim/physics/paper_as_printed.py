"""The paper's equations as they stand in print, each slip a switch; only tests and `docs/paper.md` use it.

The simulator is `plant.py`. This module exists so that each misprint's effect can be measured by putting it in.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Reading:
    """How the equations are read; every default is the print.

    Attributes:
        area_in_16: Area that P1 is multiplied with in the last term of equation 16: "A2" in print, "A1" right.
        constants: "rounded" 0.53 and 0.58 in equations 28-31, or "exact" from k.
        rod_atmosphere: Whether the atmosphere presses on the rod in equation 32: it does not in print.
        inflow: Temperature of the gas that enters in equation 40: the cylinder's, "T_p", in print; "T_0" right.
        exhaust_sign: Sign of equation 42's right side: +1 in print, -1 right (the flow of equation 43 is positive).
        dead_volume: Volume left at either end [m^3]: none in print.
        closure: What gives temperatures, on which the paper is silent: "mass" balance, "isothermal" or "isentropic".
    """

    area_in_16: str = "A2"
    constants: str = "rounded"
    rod_atmosphere: bool = False
    inflow: str = "T_p"
    exhaust_sign: int = 1
    dead_volume: float = 0.0
    closure: str = "mass"


PRINTED = Reading()
#: Letters and signs set right; roundings, missing atmosphere and missing dead volume stay.
PRINTED_FIXED_TYPOS = replace(PRINTED, area_in_16="A1", inflow="T_0", exhaust_sign=-1)
CORRECTED = replace(PRINTED_FIXED_TYPOS, constants="exact", rod_atmosphere=True)


@dataclass(frozen=True)
class Machine:
    """What moves: areas [m^2], stroke [m], mass [kg], throat areas [m^2], supply [Pa, K], atmosphere [Pa], gas."""

    area_1: float
    area_2: float
    stroke: float
    mass: float
    throat: float
    supply: float = 7e5
    temperature: float = 293.15
    atmosphere: float = 101325.0
    k: float = 1.4
    r: float = 287.05


def flow_factor(ratio: float, k: float, reading: Reading) -> float:
    """Return gamma of equations 28 and 29.

    Raises:
        ValueError: a ratio above 1: the print has no flow that turns round.
    """
    if ratio > 1.0:
        raise ValueError(f"pressure ratio {ratio:.6f} is above 1: the printed equations know one direction of flow only")
    critical, choked = 0.53, 0.58
    if reading.constants == "exact":
        critical = (2.0 / (k + 1.0)) ** (k / (k - 1.0))
        choked = (2.0 / (k + 1.0)) ** ((k + 1.0) / (2.0 * (k - 1.0)))
    if ratio <= critical:
        return choked
    y = ratio ** (1.0 / k)
    return math.sqrt(2.0 / (k - 1.0) * y * (y - ratio))


def literal_throat_mach(ratio: float, k: float) -> float:
    """Return equation 24 as the print can be read, exponent 1/2 and radical both: not 1 where the throat chokes."""
    return (2.0 / (k - 1.0) * math.sqrt(ratio ** ((1.0 - k) / k) - 1.0)) ** 0.5


def _temperature(p: float, v: float, m: float, t_0: float, p_0: float, machine: Machine, reading: Reading) -> float:
    if reading.closure == "isothermal":
        return t_0
    if reading.closure == "isentropic":
        return t_0 * (p / p_0) ** ((machine.k - 1.0) / machine.k)
    return p * v / (m * machine.r)


def _inside(x: float, machine: Machine, reading: Reading) -> None:
    if reading.dead_volume <= 0.0 and not 0.0 < x < machine.stroke:
        raise ValueError(f"piston at {x:.6f} m: without dead volume the printed equations hold between 0 and {machine.stroke} m only")


def double_acting(
    machine: Machine, reading: Reading, x: float, p_1: float, p_2: float, seconds: float
) -> NDArray[np.float64]:
    """Return (X, v, P1, T1, P2, T2) after chamber 1 has filled and chamber 2 vented for some time, from rest.

    Equations 16, 30, 31 and 32 with the closure of physics: chamber 2 by its own balance, both masses integrated.

    Raises:
        ValueError: the motion leaves what the print describes.
    """
    k, r, t_0 = machine.k, machine.r, machine.temperature
    dead = reading.dead_volume
    wrong = machine.area_2 if reading.area_in_16 == "A2" else machine.area_1

    def temperatures(z: NDArray[np.float64]) -> tuple[float, float]:
        v_1, v_2 = dead + machine.area_1 * z[0], dead + machine.area_2 * (machine.stroke - z[0])
        return (
            _temperature(z[2], v_1, z[4], t_0, p_1, machine, reading),
            _temperature(z[3], v_2, z[5], t_0, p_2, machine, reading),
        )

    def rates(_: float, z: NDArray[np.float64]) -> list[float]:
        at, speed, q_1, q_2 = z[:4]
        _inside(at, machine, reading)
        v_1, v_2 = dead + machine.area_1 * at, dead + machine.area_2 * (machine.stroke - at)
        _, t_2 = temperatures(z)
        into = flow_factor(q_1 / machine.supply, k, reading) * math.sqrt(k / (r * t_0)) * machine.supply * machine.throat
        out = flow_factor(machine.atmosphere / q_2, k, reading) * math.sqrt(k / (r * t_2)) * q_2 * machine.throat
        rate_2 = (-k * r * out * t_2 + k * q_2 * machine.area_2 * speed) / v_2
        whole = k * r * (into * t_0 - out * t_2) - k * (q_1 * wrong - q_2 * machine.area_2) * speed
        rate_1 = (whole - rate_2 * v_2) / v_1
        push = q_1 * machine.area_1 - q_2 * machine.area_2
        if reading.rod_atmosphere:
            push -= machine.atmosphere * (machine.area_1 - machine.area_2)
        return [speed, push / machine.mass, rate_1, rate_2, into, -out]

    m_1 = p_1 * (dead + machine.area_1 * x) / (r * t_0)
    m_2 = p_2 * (dead + machine.area_2 * (machine.stroke - x)) / (r * t_0)
    z = _integrate(rates, [x, 0.0, p_1, p_2, m_1, m_2], seconds)
    t_1, t_2 = temperatures(z)
    return np.array([z[0], z[1], z[2], t_1, z[3], t_2])


def single_acting(machine: Machine, reading: Reading, x: float, p: float, seconds: float, fills: bool = True) -> NDArray[np.float64]:
    """Return (X, v, P, T) after a single-acting cylinder has filled or vented for some time, from rest (equations 40-44).

    Raises:
        ValueError: the motion leaves what the print describes.
    """
    k, r, t_0 = machine.k, machine.r, machine.temperature
    dead = reading.dead_volume

    def rates(_: float, z: NDArray[np.float64]) -> list[float]:
        at, speed, q, m = z
        _inside(at, machine, reading)
        volume = dead + machine.area_1 * at
        t = _temperature(q, volume, m, t_0, p, machine, reading)
        if fills:
            w = flow_factor(q / machine.supply, k, reading) * math.sqrt(k / (r * t_0)) * machine.supply * machine.throat
            carried, into = k * r * w * (t if reading.inflow == "T_p" else t_0), w
        else:
            w = flow_factor(machine.atmosphere / q, k, reading) * math.sqrt(k / (r * t)) * q * machine.throat
            carried, into = reading.exhaust_sign * k * r * w * t, -w
        rate = (carried - k * q * machine.area_1 * speed) / volume
        return [speed, (q - machine.atmosphere) * machine.area_1 / machine.mass, rate, into]

    z = _integrate(rates, [x, 0.0, p, p * (dead + machine.area_1 * x) / (r * t_0)], seconds)
    return np.array([z[0], z[1], z[2], _temperature(z[2], dead + machine.area_1 * z[0], z[3], t_0, p, machine, reading)])


def flow_of_equation_39(power: float, supply_gauge: float, share: float = 0.5, atmosphere: float | None = None) -> float:
    """Return Q0 = W/(P0 - P2) of equation 39 [m^3/s]: P2 a share of the gauge supply, as in print, or of the absolute one.

    Args:
        power: [W].
        supply_gauge: Supply above the atmosphere [Pa].
        share: P2 over P0.
        atmosphere: Where given, pressures are taken absolute [Pa].
    """
    supply = supply_gauge + (atmosphere or 0.0)
    return power / (supply * (1.0 - share))


def _integrate(
    rates: Callable[[float, NDArray[np.float64]], list[float]], start: list[float], seconds: float
) -> NDArray[np.float64]:
    from scipy.integrate import solve_ivp

    scale = np.maximum(np.abs(start), 1e-3)
    end: NDArray[np.float64] = solve_ivp(
        rates, (0.0, seconds), start, "DOP853", rtol=1e-11, atol=1e-11 * scale, max_step=1e-3
    ).y[:, -1]
    return end
