"""Dry friction that falls once the piston moves."""

from __future__ import annotations

import math

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Asked, Effect, Parameter

EFFECT = Effect(
    name="stribeck_friction",
    places=("cylinder", "joint"),
    question="Does it take more force to start than to keep going slowly?",
    says="Friction is higher at rest and falls as motion starts.",
    parameters=(
        Parameter(
            "breakaway",
            "N",
            0.0,
            1e5,
            (2.0, 100.0),
            "5-60 N for 16-50 mm bores: the whole force at rest",
            angular_unit="N*m",
        ),
        Parameter("velocity", "m/s", 1e-4, 10.0, (5e-3, 0.1), "5-100 mm/s", angular_unit="rad/s"),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("coulomb_friction", "viscous_friction", "presliding", "backlash"),
    experiment="slow triangles at three speeds between 1 and 100 mm/s",
    convention=(
        "breakaway is the whole force at rest, not what it has more than Coulomb's; the excess falls as "
        "exp(-(v/velocity)^2)."
    ),
    signature="the piston jumps when it starts; friction falls over the first centimetres a second",
    asked=Asked(on_top_of="coulomb_friction"),
)


@kernel
def excess(p, level: float, v: float) -> float:
    """Return what is added to the other dry friction at this speed; `breakaway` is the whole force at rest [N or N m]."""
    if p.breakaway <= level:
        return 0.0
    ratio = v / p.velocity
    return (p.breakaway - level) * math.exp(-ratio * ratio)
