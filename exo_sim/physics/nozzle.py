"""Flow of a perfect gas through a converging nozzle, choked and not (the paper's equations 17-31)."""

from __future__ import annotations

import math

from exo_sim.physics import subsonic_air
from exo_sim.physics.compiled import inlined_kernel, kernel

#: Above this pressure ratio the flow falls linearly to zero: the nozzle's slope is infinite at equal pressures.
LAMINAR_RATIO = 0.999

#: Below this pressure ratio every gas with k up to 2 chokes.
_SURELY_CHOKED = 0.44

#: Gamma of the choked flow of air: a power that every step of every prediction would take anew.
_AIR = subsonic_air.K
_CHOKED_AIR = (2.0 / (_AIR + 1.0)) ** ((_AIR + 1.0) / (2.0 * (_AIR - 1.0)))

#: The same of the gamma where the flow becomes linear.
_LINEAR_POWER = LAMINAR_RATIO ** (1.0 / _AIR)
_LINEAR_AIR = math.sqrt(2.0 / (_AIR - 1.0) * (_LINEAR_POWER * (_LINEAR_POWER - LAMINAR_RATIO)))


@kernel
def critical_ratio(k: float) -> float:
    """Return the pressure ratio at which the throat chokes, exactly (the paper prints 0.53).

    Args:
        k: Ratio of specific heats.
    """
    return (2.0 / (k + 1.0)) ** (k / (k - 1.0))


@inlined_kernel
def critical_flow_factor(k: float) -> float:
    """Return gamma of choked flow, exactly (the paper's equation 29 prints 0.58)."""
    if k == _AIR:
        return _CHOKED_AIR
    return (2.0 / (k + 1.0)) ** ((k + 1.0) / (2.0 * (k - 1.0)))


@kernel
def throat_mach(ratio: float, k: float) -> float:
    """Return the Mach number at the throat from its pressure ratio (equation 24, exponent set right)."""
    return math.sqrt(2.0 / (k - 1.0) * (ratio ** ((1.0 - k) / k) - 1.0))


@kernel
def subsonic_flow_factor(ratio: float, k: float) -> float:
    """Return gamma of equation 26 for a throat pressure ratio between critical and 1."""
    y = ratio ** (1.0 / k)
    return math.sqrt(2.0 / (k - 1.0) * max(y * (y - ratio), 0.0))


@inlined_kernel
def laminar_flow_factor(k: float) -> float:
    """Return gamma at the pressure ratio above which the flow falls linearly."""
    if k == _AIR:
        return _LINEAR_AIR
    return subsonic_flow_factor(LAMINAR_RATIO, k)


@inlined_kernel
def flow_factor(ratio: float, k: float) -> float:
    """Return gamma for any downstream/upstream pressure ratio from 0 to 1 (equations 28 and 29), linear above 0.999.

    The law is continuously differentiable at the critical ratio; its slope is finite at 1.
    """
    if ratio < _SURELY_CHOKED and k <= 2.0:
        return critical_flow_factor(k)
    if ratio < LAMINAR_RATIO:
        if k == _AIR:
            return _CHOKED_AIR if ratio <= subsonic_air.CHOKES else subsonic_air.flow_factor(ratio)
        y = ratio ** (1.0 / k)
        if 2.0 * y >= (k + 1.0) * ratio:  # where gamma's slope vanishes: the critical ratio, without a second power
            return critical_flow_factor(k)
        return math.sqrt(2.0 / (k - 1.0) * max(y * (y - ratio), 0.0))
    return laminar_flow_factor(k) * max(1.0 - ratio, 0.0) / (1.0 - LAMINAR_RATIO)


@kernel
def choked_flow(area: float, pressure: float, temperature: float, k: float, r: float) -> float:
    """Return the choked mass flow [kg/s]; arguments as of `mass_flow`."""
    return critical_flow_factor(k) * math.sqrt(k / (r * temperature)) * pressure * area


@inlined_kernel
def mass_flow(area: float, pressure: float, temperature: float, pressure_down: float, k: float, r: float) -> float:
    """Return the mass flow from a stagnant upstream gas [kg/s] (equation 27).

    Args:
        area: Effective throat area [m^2], discharge coefficient included.
        pressure: Upstream, absolute [Pa]; not below `pressure_down`.
        temperature: Upstream [K].
        pressure_down: Downstream, absolute [Pa].
        k: Ratio of specific heats.
        r: Specific gas constant [J/(kg K)].
    """
    return flow_factor(pressure_down / pressure, k) * math.sqrt(k / (r * temperature)) * pressure * area


@inlined_kernel
def flow(area: float, p_a: float, t_a: float, p_b: float, t_b: float, k: float, r: float) -> float:
    """Return the mass flow from a to b [kg/s], negative where b is upstream: the upstream gas decides (equations 30, 31)."""
    if area <= 0.0:
        return 0.0
    if p_a >= p_b:
        return mass_flow(area, p_a, t_a, p_b, k, r)
    return -mass_flow(area, p_b, t_b, p_a, k, r)
