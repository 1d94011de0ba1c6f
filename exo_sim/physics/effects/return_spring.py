"""A spring that nobody mentioned."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Asked, Effect, Parameter

EFFECT = Effect(
    name="return_spring",
    places=("cylinder", "joint"),
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
    signature="balance of forces drifts in proportion to position",
    asked=Asked(forms=(("stiffness", "rest"),)),
)


@kernel
def force(p, x: float) -> float:
    """Return the spring's force towards smaller x [N or N m]."""
    return p.stiffness * (x - p.rest)
