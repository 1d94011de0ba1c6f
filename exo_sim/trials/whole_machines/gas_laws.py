"""Laws of flow and heat, of which each make of machine follows its own.

Flow through a valve path is its choked capacity times a factor of the pressure ratio: the ellipse of ISO 6358-1 with a subsonic index
(m = 1/2 is the ellipse), de Saint-Venant and Wantzel's nozzle behind which part of the pressure is recovered, so that it chokes at b, or
a sharp edge, whose jet contracts to 0.61 of the opening when it is slow (Kirchhoff) and to 0.84 of it into a vacuum (Perry 1949), so that
it never quite chokes. Heat is Newton's with a constant conductance, with the wetted wall, with Eichelberg's root of pressure times
temperature, or with a Reynolds number of the piston's motion to the power of 0.7 (Annand 1963).
"""

from __future__ import annotations

import math

from exo_sim.trials.whole_machines.compiled import kernel

ELLIPSE, NOZZLE, SHARP = 0, 1, 2
ORIFICE, GAP, POROUS, CLEARANCE = 0, 1, 2, 3
CONSTANT, WETTED, EICHELBERG, STIRRED = 0, 1, 2, 3

#: Towards equal pressures every flow is taken as laminar: linear in the ratio from here, where a valve does not say it of itself.
_LINEAR = 0.998
#: What stirs the gas of a chamber whose piston rests, and the speed at which `STIRRED` has its coefficient [m/s].
_CALM, _BRISK = 0.03, 0.3


@kernel
def _nozzle(r, k):
    return math.sqrt(max(r ** (2.0 / k) - r ** ((k + 1.0) / k), 0.0))


@kernel
def flow_factor(ratio, law, b, m, k, laminar=_LINEAR):
    """Return flow over choked flow for a ratio of downstream to upstream pressure; it is laminar above a ratio of `laminar`."""
    r = min(ratio, laminar)
    if law == SHARP:
        throat = (2.0 / (k + 1.0)) ** (k / (k - 1.0))
        factor = (_nozzle(r, k) / _nozzle(throat, k) if r > throat else 1.0) * (1.0 - 0.23 / 0.84 * r**1.5)
    elif r <= b:
        factor = 1.0
    elif law == ELLIPSE:
        s = (r - b) / (1.0 - b)
        inside = 1.0 - s * s
        factor = math.sqrt(inside) if m == 0.5 else inside**m
    else:
        throat = (2.0 / (k + 1.0)) ** (k / (k - 1.0))
        factor = _nozzle(1.0 - (1.0 - r) * (1.0 - throat) / (1.0 - b), k) / _nozzle(throat, k)
    return factor if ratio <= laminar else factor * (1.0 - ratio) / (1.0 - laminar)


@kernel
def orifice(area, p_a, t_a, p_b, t_b, law, b, m, crack, g, laminar=_LINEAR):
    """Return the mass flow from a to b [kg/s]; `crack` [Pa] is what the difference must exceed before anything flows."""
    if area <= 0.0:
        return 0.0
    if p_a >= p_b:
        up, down, temperature, sign = p_a, p_b + crack, t_a, 1.0
    else:
        up, down, temperature, sign = p_b, p_a + crack, t_b, -1.0
    if down >= up:
        return 0.0
    return sign * g.sonic * area * up / math.sqrt(temperature) * flow_factor(down / up, law, b, m, g.heat_ratio, laminar)


@kernel
def leak(size, p_a, t_a, p_b, t_b, law, inertial, turning, g):
    """Return the mass flow of a leak from a to b [kg/s].

    A sharp edge, a laminar gap, a porous path (Forchheimer), or a clearance: laminar up to the flow `turning` [kg/s], from there
    turbulent after Blasius, the difference of squared pressures growing as its power of 1.75.

    `size` is an area [m^2] for an edge, else kg/(s Pa^2); `inertial` [Pa^2 s^2/kg^2] belongs to the porous path.
    """
    if size <= 0.0:
        return 0.0
    if law == ORIFICE:
        return orifice(size, p_a, t_a, p_b, t_b, NOZZLE, 0.5282817877171742, 0.5, 0.0, g)
    drop = p_a * p_a - p_b * p_b
    if law == GAP:
        # viscosity of air grows as T^0.7, density falls as 1/T
        return size * drop * (293.15 / (t_a if drop > 0.0 else t_b)) ** 1.7
    if law == CLEARANCE:
        smooth = size * abs(drop)
        if smooth > turning:
            smooth = turning * (smooth / turning) ** (1.0 / 1.75)
        return smooth if drop > 0.0 else -smooth
    flow = 0.5 * (math.sqrt(1.0 / (size * size) + 4.0 * inertial * abs(drop)) - 1.0 / size) / inertial
    return flow if drop > 0.0 else -flow


@kernel
def conductance(law, constant, coefficient, end_area, barrel, length, pressure, temperature, speed):
    """Return the conductance from gas to wall [W/K] of a chamber whose open length is `length` [m].

    Args:
        law: Of `CONSTANT`, `WETTED`, `EICHELBERG`, `STIRRED`.
        constant: Conductance [W/K] of the first law.
        coefficient: Heat transfer coefficient [W/(m^2 K)] of the others, for the third and fourth at 4 bar and 293 K, for the fourth at
            0.3 m/s.
        end_area, barrel: Wall that is always wetted [m^2], and wall per metre of length [m].
        length, pressure, temperature, speed: State of the chamber; the speed is the piston's [m/s].
    """
    if law == CONSTANT:
        return constant
    wall = coefficient * (end_area + barrel * max(length, 0.0))
    if law == EICHELBERG:
        wall *= math.sqrt(pressure * temperature / (4e5 * 293.15))
    elif law == STIRRED:
        wall *= (pressure * 293.15 / (4e5 * temperature) * (_CALM + abs(speed)) / (_CALM + _BRISK)) ** 0.7
    return wall
