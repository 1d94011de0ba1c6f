"""Density of air as a real gas, for bottles: a perfect gas overstates what 300 bar hold by a tenth.

The residual part of the pseudo-pure equation of state of dry air by Lemmon, Jacobsen, Penoncello and Friend (J. Phys. Chem. Ref. Data 29,
331, 2000), in the single phase: densities within 0.1 % from the dew line to 873 K and 700 bar.
"""

from __future__ import annotations

import math

#: Molar gas constant of the equation [J/(mol K)], and the point that it is reduced by [K], [mol/m^3].
_R, _T_J, _RHO_J = 8.31451, 132.6312, 10447.7
#: Of dry air [kg/mol], that of the specific gas constant 287.05 J/(kg K).
MOLAR_MASS = 0.02896546

#: Where the equation holds, away from its dew line [K], [Pa].
TEMPERATURES, PRESSURES = (200.0, 873.0), (0.0, 7e7)

#: Terms n delta^i tau^j exp(-delta^l): n, i, j, l (their table 13).
_TERMS = (
    (0.118160747229, 1, 0.0, 0), (0.713116392079, 1, 0.33, 0), (-1.61824192067, 1, 1.01, 0), (0.0714140178971, 2, 0.0, 0),
    (-0.0865421396646, 3, 0.0, 0), (0.134211176704, 3, 0.15, 0), (0.0112626704218, 4, 0.0, 0), (-0.0420533228842, 4, 0.2, 0),
    (0.0349008431982, 4, 0.35, 0), (0.000164957183186, 6, 1.35, 0), (-0.101365037912, 1, 1.6, 1), (-0.173813690970, 3, 0.8, 1),
    (-0.0472103183731, 5, 0.95, 1), (-0.0122523554253, 6, 1.25, 1), (-0.146629609713, 1, 3.6, 2), (-0.0316055879821, 3, 6.0, 2),
    (0.000233594806142, 11, 3.25, 2), (0.0148287891978, 1, 3.5, 3), (-0.00938782884667, 3, 15.0, 3),
)  # fmt: skip


def pressure(density: float, temperature: float) -> float:
    """Return the pressure of dry air [Pa] at a density [kg/m^3] and a temperature [K]: rho R T (1 + delta d(alpha_r)/d(delta))."""
    molar = density / MOLAR_MASS
    delta, tau = molar / _RHO_J, _T_J / temperature
    total = 0.0
    for n, i, j, power in _TERMS:
        damped = delta**power if power else 0.0
        total += n * delta**i * tau**j * math.exp(-damped) * (i - power * damped)
    return molar * _R * temperature * (1.0 + total)


def density(pressure_wanted: float, temperature: float) -> float:
    """Return the density of dry air [kg/m^3].

    Args:
        pressure_wanted: Absolute [Pa], up to 700 bar.
        temperature: 200 to 873 K.

    Raises:
        ValueError: outside that range.

    >>> round(density(101325.0, 293.15), 4)
    1.2046
    """
    if not TEMPERATURES[0] <= temperature <= TEMPERATURES[1] or not PRESSURES[0] < pressure_wanted <= PRESSURES[1]:
        raise ValueError(
            f"the equation of state of air holds from 200 to 873 K up to 700 bar, not at {pressure_wanted:g} Pa and {temperature:g} K"
        )
    low, high = 0.0, 1500.0
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if pressure(middle, temperature) < pressure_wanted:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def compressibility(pressure_at: float, temperature: float) -> float:
    """Return Z = p/(rho R T) of dry air; arguments as of `density`."""
    return pressure_at * MOLAR_MASS / (density(pressure_at, temperature) * _R * temperature)
