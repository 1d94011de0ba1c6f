"""Resistance that grows with the square of speed."""

from __future__ import annotations

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.terms import DAMPING

EFFECT = Effect(
    name="quadratic_drag",
    places=("cylinder", "joint"),
    family="friction",
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
    valid="what resists is a turbulent flow around the part, of one density.",
    signature="fast motion loses more than slow motion foretells",
    identification=Identification(prevalence=0.08),
)


@DAMPING.of(EFFECT)
def damping(p, motion):
    """Return the resistance for each unit of speed [N s/m or N m s/rad]."""
    return p.coefficient * abs(motion.v)
