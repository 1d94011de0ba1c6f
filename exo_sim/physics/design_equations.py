"""The paper's steady relations between power, pressure and flow (equations 35-39) in the corrected form, and stiffness.

All in SI with absolute pressures. The paper takes the exhaust density for the supply's in equation 38 and mixes gauge and absolute
pressures in equation 39; `docs/paper.md` has both with their effect in numbers.
"""

from __future__ import annotations

import math

#: One mechanical horsepower [W].
HORSEPOWER = 745.6998715822702


def rod_power(p_1: float, p_2: float, area_1: float, area_2: float, p_atm: float, speed: float) -> float:
    """Return the power of a constant-pressure stroke at the rod [W] (equation 35 with the atmosphere on the rod).

    Args:
        p_1, p_2: Driving and opposing pressure [Pa].
        area_1, area_2: Areas they act on [m^2].
        p_atm: Atmosphere, on the rod's cross-section [Pa].
        speed: Of the piston, towards chamber 2 [m/s].

    >>> round(rod_power(7e5, 2e5, 8e-4, 7e-4, 101325.0, 0.5), 3)
    204.934
    """
    return (p_1 * area_1 - p_2 * area_2 - p_atm * (area_1 - area_2)) * speed


def supply_flow(power: float, p_0: float, p_1: float, p_2: float, area_1: float, area_2: float, p_atm: float) -> float:
    """Return the volume flow that a stroke of this power takes from the supply [m^3/s at p_0 and its temperature].

    By displacement, Q0 = p_1 A1 v / p_0: no temperature enters. It is the paper's Q0 = W/(P0 - P2) where p_1 = p_0 and
    A1 = A2 (equation 38, whose gas constant is an error).

    Args:
        power: At the rod [W].
        p_0: Supply [Pa].
        p_1, p_2, area_1, area_2, p_atm: As in `rod_power`.

    One horsepower between 250 psi gauge and half of that, the paper's equation 39: 52.8 cubic inches a second.

    >>> psi = 6894.757293168361
    >>> q = supply_flow(HORSEPOWER, 264.695949 * psi, 264.695949 * psi, 139.695949 * psi, 1e-3, 1e-3, 101325.0)
    >>> round(q / 0.0254**3, 6)
    52.8

    Half of the absolute supply pressure instead:

    >>> q = supply_flow(HORSEPOWER, 264.695949 * psi, 264.695949 * psi, 132.3479745 * psi, 1e-3, 1e-3, 101325.0)
    >>> round(q / 0.0254**3, 4)
    49.8685
    """
    force = p_1 * area_1 - p_2 * area_2 - p_atm * (area_1 - area_2)
    return power * (p_1 * area_1 / p_0) / force


def mass_flow(volume_flow: float, p_0: float, temperature: float, r: float = 287.05) -> float:
    """Return the mass flow of a volume flow at supply conditions [kg/s] (equation 36).

    Args:
        volume_flow: [m^3/s] at p_0 and temperature.
        p_0: [Pa].
        temperature: [K].
        r: Specific gas constant [J/(kg K)].

    >>> round(mass_flow(8.652369792e-4, 1825014.323292, 293.15), 8)
    0.01876523
    """
    return volume_flow * p_0 / (r * temperature)


def free_air(volume_flow: float, p_0: float, p_atm: float = 101325.0) -> float:
    """Return a supply flow as free air of the same temperature [m^3/s].

    >>> round(1e3 * free_air(8.652369792e-4, 1825014.323292), 4)
    15.5842
    """
    return volume_flow * p_0 / p_atm


def throat_area(flow: float, p_0: float, temperature: float, k: float = 1.4, r: float = 287.05) -> float:
    """Return the smallest effective throat that passes a mass flow choked [m^2] (equation 30, exact).

    Args:
        flow: [kg/s].
        p_0, temperature: Upstream [Pa], [K].
        k, r: Ratio of specific heats; specific gas constant [J/(kg K)].

    >>> round(1e6 * throat_area(1.876523035225e-2, 1825014.323292, 293.15), 5)
    4.35603
    """
    choked = (2.0 / (k + 1.0)) ** ((k + 1.0) / (2.0 * (k - 1.0)))
    return flow / (choked * math.sqrt(k / (r * temperature)) * p_0)


def available_power(flow: float, p_0: float, temperature: float, p_atm: float = 101325.0, r: float = 287.05) -> float:
    """Return the most work a second that a supply flow could do at constant temperature [W].

    >>> round(available_power(1.876523035225e-2, 1825014.323292, 293.15), 3)
    4565.107
    """
    return flow * r * temperature * math.log(p_0 / p_atm)


def exhaust_temperature(supply_temperature: float, p_0: float, p_2: float, k: float = 1.4) -> float:
    """Return the mean temperature of what a full-pressure cycle exhausts [K]: fill at p_0, expand to p_2, expel.

    Equation 35 read as an energy balance would give T0 p_2/p_0, a drop k/(k-1) times too large.

    >>> round(exhaust_temperature(293.15, 1825014.323292, 963169.661646), 3)
    253.597
    """
    return supply_temperature * (1.0 - (k - 1.0) / k * (1.0 - p_2 / p_0))


def stiffness(
    p_1: float, p_2: float, area_1: float, area_2: float, volume_1: float, volume_2: float, n: float = 1.4
) -> float:
    """Return the stiffness of two closed chambers [N/m].

    Args:
        p_1, p_2: [Pa].
        area_1, area_2: [m^2].
        volume_1, volume_2: Dead volumes included [m^3].
        n: 1 for slow, k for fast motion.

    >>> a_1, a_2 = 8.042477193189871e-4, 6.911503837897546e-4
    >>> round(stiffness(5e5, 565237.727273, a_1, a_2, a_1 * 0.05, a_2 * 0.05), 3)
    22198.068
    """
    return n * (p_1 * area_1**2 / volume_1 + p_2 * area_2**2 / volume_2)


def natural_frequency(stiffness: float, mass: float) -> float:
    """Return the frequency of a mass on a stiffness [Hz].

    >>> round(natural_frequency(22198.06769, 5.0), 6)
    10.604562
    """
    return math.sqrt(stiffness / mass) / (2.0 * math.pi)
