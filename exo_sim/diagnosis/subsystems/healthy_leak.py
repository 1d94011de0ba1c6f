"""Leaks that every cylinder has: they take minutes to empty it."""

from __future__ import annotations

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy import healthy
from exo_sim.physics.effects import external_leakage

#: The leak from a chamber to the atmosphere.
OUTWARD = external_leakage.EFFECT
#: Leaks of a healthy cylinder for its swept volume, by their unit [m^2/m^3, kg/(s Pa^2 m^3)].
BY_UNIT = {"m^2": healthy.LEAK_AREA, "kg/(s Pa^2)": healthy.LEAK_LAMINAR}


def swept_volume(plant: PlantParameters) -> float:
    """Return the volume that the piston sweeps in chamber 1 [m^3]."""
    return float(plant.cylinder["area_1"][0] * plant.cylinder["stroke"][0])


def external_leaks(plant: PlantParameters) -> dict[str, float]:
    """Return, by parameter of a leak to the atmosphere, what a healthy cylinder has of it [m^2, kg/(s Pa^2)]."""
    swept = swept_volume(plant)
    return {p.name: BY_UNIT[p.unit] * swept for p in OUTWARD.parameters if p.unit in BY_UNIT}
