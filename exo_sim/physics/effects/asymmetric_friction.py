"""Dry friction that differs with direction."""

from __future__ import annotations

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability, Twins
from exo_sim.physics.terms import DRY_FRICTION

EFFECT = Effect(
    name="asymmetric_friction",
    places=("cylinder", "joint"),
    family="friction",
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
    valid="the seals rub at levels that do not change with speed, pressure, place or time at rest, and no constant force acts that the rig "
    "lacks, as on a bench that is not level: beside that, friction of one level looks the same until the machine is turned round.",
    signature="the loop of force against position is not centred on the load",
    # at a joint that moves, Coulomb friction beside a constant torque says the same in simpler words
    identification=Identification(
        applicability=Applicability(places=("cylinder",)), twins=Twins(beside_constant="coulomb_friction"), prevalence=0.3
    ),
)


@DRY_FRICTION.of(EFFECT)
def level(p, motion):
    """Return the dry friction that a motion, or a push at rest, meets in its direction [N or N m]."""
    direction = motion.bristle if motion.bristle != 0.0 else motion.v
    return p.forward if direction > 0.0 else p.backward
