"""A spring that nobody mentioned."""

from __future__ import annotations

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import ObservedMotion, Starts
from exo_sim.physics.terms import SPRING_FORCE


def _starts(seen: ObservedMotion) -> Starts:
    """Return values to begin with; stiffness times rest is one number, so that a bad start for one of them traps the other."""
    sizes, rests = (0.2, 1.0), (-4.0, -1.5, 0.0, 1.5, 4.0)
    return tuple((s * seen.force / seen.travel, seen.middle + r * seen.travel) for s in sizes for r in rests)


EFFECT = Effect(
    name="return_spring",
    places=("cylinder", "joint"),
    family="spring",
    question="Does the force needed to hold still grow with position?",
    says="A spring acts between the moving parts.",
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            0.0,
            1e7,
            (50.0, 5e3),
            "return springs of single-acting cylinders",
            angular_unit="N*m/rad",
        ),
        Parameter(
            "rest", "m", -10.0, 10.0, (0.0, 0.2), "where the spring is slack", angular_unit="rad", required=False
        ),
    ),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("payload_mass", "asymmetric_friction", "sensor_bias"),
    experiment="hold still at three positions",
    convention=(
        "on a cylinder, rest is a piston position X from the far left end; on a joint it is the joint's "
        "coordinate. + stiffness pulls towards rest."
    ),
    valid="the spring is straight in force over travel, without mass, and never goes solid or loose.",
    signature="balance of forces drifts in proportion to position",
    identification=Identification(forms=(("stiffness", "rest"),), starts_by_motion=_starts, within_travels=("rest",), resists=1.0),
)


@SPRING_FORCE.of(EFFECT)
def force(p, motion):
    """Return the spring's force towards smaller x [N or N m]."""
    return p.stiffness * (motion.x - p.rest)
