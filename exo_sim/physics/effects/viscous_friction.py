"""Resistance in proportion to speed."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Effect, Parameter

EFFECT = Effect(
    name="viscous_friction",
    places=("cylinder", "joint"),
    question="Does resistance grow in proportion to speed?",
    says="Viscous friction resists motion.",
    parameters=(
        Parameter(
            "coefficient", "N s/m", 0.0, 1e5, (5.0, 250.0), "10-150 N s/m for 16-50 mm bores", angular_unit="N*m*s/rad"
        ),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("quadratic_drag", "pressure_dependent_friction", "stribeck_friction", "wall_heat_transfer"),
    experiment="constant speeds, three of them",
    signature="the pressure difference at constant speed grows in proportion",
)


@kernel
def force(p, v: float) -> float:
    """Return the force against the motion, along +v [N or N m]."""
    return p.coefficient * v
