"""Mass and energy of one chamber (the paper's equations 1-13, kept for each chamber alone)."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel


@kernel
def pressure(energy: float, volume: float, k: float) -> float:
    """Return the absolute pressure [Pa] of a perfect gas from its internal energy [J] (equation 5)."""
    return (k - 1.0) * energy / volume


@kernel
def temperature(energy: float, mass: float, k: float, r: float) -> float:
    """Return the temperature [K] from internal energy [J] and mass [kg] (equation 3)."""
    return (k - 1.0) * energy / (mass * r)


@kernel
def contents(pressure: float, temperature: float, volume: float, k: float, r: float) -> tuple[float, float]:
    """Return mass [kg] and internal energy [J] of a gas at rest."""
    return pressure * volume / (r * temperature), pressure * volume / (k - 1.0)


@kernel
def enthalpy_flow(mass_flow: float, t_source: float, t_chamber: float, k: float, r: float) -> float:
    """Return the enthalpy carried into a chamber [W]: gas brings the temperature of where it comes from (equations 9, 10)."""
    cp = k * r / (k - 1.0)
    return mass_flow * cp * (t_source if mass_flow > 0.0 else t_chamber)
