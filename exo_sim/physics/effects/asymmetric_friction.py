"""Dry friction that differs with direction."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Effect, Parameter

EFFECT = Effect(
    name="asymmetric_friction",
    places=("cylinder", "joint"),
    question="Does the outward stroke meet another friction than the inward one?",
    says="Dry friction differs between the two directions.",
    parameters=(
        Parameter(
            "forward", "N", 0.0, 1e5, (1.0, 60.0), "as Coulomb; lip seals differ by up to a half", angular_unit="N*m"
        ),
        Parameter(
            "backward", "N", 0.0, 1e5, (1.0, 60.0), "as Coulomb; lip seals differ by up to a half", angular_unit="N*m"
        ),
    ),
    cut="motion",
    absorbs=(("coulomb_friction", (("forward", "force"), ("backward", "force"))),),
    reveals=("position", "force"),
    mistaken_for=("coulomb_friction", "sensor_bias", "return_spring"),
    experiment="slow triangles with both chambers open to the atmosphere: a bias then cannot come from pressure sensors",
    convention=(
        "forward and backward are the whole dry friction of each direction: this effect takes the place of "
        "coulomb_friction. Forward is towards larger position (outwards)."
    ),
    signature="the loop of force against position is not centred on the load",
)


@kernel
def level(p, direction: float) -> float:
    """Return the dry friction that a motion, or a push at rest, in this direction meets [N or N m]."""
    return p.forward if direction > 0.0 else p.backward
