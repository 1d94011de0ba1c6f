"""Volumes and rod force of a cylinder, double and single acting (the paper's equations 14, 15, 32, 40-44)."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel


@kernel
def volume_1(x: float, area_1: float, dead_volume_1: float) -> float:
    """Return the volume of chamber 1 [m^3] with the piston at x from its end (equation 14 with dead volume)."""
    return dead_volume_1 + area_1 * x


@kernel
def volume_2(x: float, area_2: float, dead_volume_2: float, stroke: float) -> float:
    """Return the volume of chamber 2 [m^3] with the piston at x from the far end (equation 14 with dead volume)."""
    return dead_volume_2 + area_2 * (stroke - x)


@kernel
def rod_force(p_1: float, p_2: float, area_1: float, area_2: float, p_atm: float) -> float:
    """Return the force on the rod [N], + pushes out: equation 32 with the atmosphere on the rod's cross-section."""
    return p_1 * area_1 - p_2 * area_2 - p_atm * (area_1 - area_2)
