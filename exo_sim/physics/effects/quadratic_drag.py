"""Resistance that grows with the square of speed."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Effect, Parameter

EFFECT = Effect(
    name="quadratic_drag",
    places=("cylinder", "joint"),
    question="Does resistance grow with the square of speed?",
    says="Drag grows with the square of speed.",
    parameters=(
        Parameter(
            "coefficient", "N s^2/m^2", 0.0, 1e6, (5.0, 500.0), "engineering estimate", angular_unit="N*m*s^2/rad^2"
        ),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("viscous_friction", "coulomb_friction"),
    experiment="constant speeds, three of them; free swings from two heights",
    signature="fast motion loses more than slow motion foretells",
)


@kernel
def force(p, v: float) -> float:
    """Return the force against the motion, along +v [N or N m]."""
    return p.coefficient * abs(v) * v
