"""Laws of flow and heat, of which each make of machine follows its own.

Flow through a valve path is its choked capacity times a factor of the pressure ratio: the ellipse of ISO 6358-1 with a subsonic index
(m = 1/2 is the ellipse), or de Saint-Venant and Wantzel's nozzle behind which part of the pressure is recovered, so that it chokes at
b. Heat is Newton's with a constant conductance, with the wetted wall, or with Eichelberg's root of pressure times temperature.
"""

from __future__ import annotations

import math

from exo_sim.trials.whole.compiled import kernel

ELLIPSE, NOZZLE = 0, 1
ORIFICE, GAP, POROUS = 0, 1, 2
CONSTANT, WETTED, EICHELBERG = 0, 1, 2

#: Towards equal pressures every flow is taken as laminar: linear in the ratio from here.
_LINEAR = 0.998


@kernel
def _nozzle(r, k):
    return math.sqrt(max(r ** (2.0 / k) - r ** ((k + 1.0) / k), 0.0))


@kernel
def flow_factor(ratio, law, b, m, k):
    """Return flow over choked flow for a ratio of downstream to upstream pressure."""
    r = min(ratio, _LINEAR)
    if r <= b:
        return 1.0
    if law == ELLIPSE:
        s = (r - b) / (1.0 - b)
        inside = 1.0 - s * s
        factor = math.sqrt(inside) if m == 0.5 else inside**m
    else:
        throat = (2.0 / (k + 1.0)) ** (k / (k - 1.0))
        factor = _nozzle(1.0 - (1.0 - r) * (1.0 - throat) / (1.0 - b), k) / _nozzle(throat, k)
    return factor if ratio <= _LINEAR else factor * (1.0 - ratio) / (1.0 - _LINEAR)


@kernel
def orifice(area, p_a, t_a, p_b, t_b, law, b, m, crack, g):
    """Return the mass flow from a to b [kg/s]; `crack` [Pa] is what the difference must exceed before anything flows."""
    if area <= 0.0:
        return 0.0
    if p_a >= p_b:
        up, down, temperature, sign = p_a, p_b + crack, t_a, 1.0
    else:
        up, down, temperature, sign = p_b, p_a + crack, t_b, -1.0
    if down >= up:
        return 0.0
    return sign * g.sonic * area * up / math.sqrt(temperature) * flow_factor(down / up, law, b, m, g.heat_ratio)


@kernel
def leak(size, p_a, t_a, p_b, t_b, law, inertial, g):
    """Return the mass flow of a leak from a to b [kg/s]: a sharp edge, a laminar gap, or a porous path (Forchheimer).

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
    flow = 0.5 * (math.sqrt(1.0 / (size * size) + 4.0 * inertial * abs(drop)) - 1.0 / size) / inertial
    return flow if drop > 0.0 else -flow


@kernel
def conductance(law, constant, coefficient, end_area, barrel, length, pressure, temperature):
    """Return the conductance from gas to wall [W/K] of a chamber whose open length is `length` [m].

    Args:
        law: Of `CONSTANT`, `WETTED`, `EICHELBERG`.
        constant: Conductance [W/K] of the first law.
        coefficient: Heat transfer coefficient [W/(m^2 K)] of the others, for the third at 4 bar and 293 K.
        end_area, barrel: Wall that is always wetted [m^2], and wall per metre of length [m].
        length, pressure, temperature: State of the chamber.
    """
    if law == CONSTANT:
        return constant
    wall = coefficient * (end_area + barrel * max(length, 0.0))
    if law == EICHELBERG:
        wall *= math.sqrt(pressure * temperature / (4e5 * 293.15))
    return wall
