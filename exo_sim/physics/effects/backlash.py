"""Free play between piston and joint."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability

#: Stiffness of the contact on either side of the gap where no compliance is declared [N/m].
CONTACT_STIFFNESS = 1e6

EFFECT = Effect(
    name="backlash",
    places=("cylinder", "joint"),
    family="transmission",
    question="Is there a stretch of motion that carries no force when the load reverses?",
    says="There is free play between piston and joint.",
    parameters=(
        Parameter(
            "gap",
            "m",
            0.0,
            0.05,
            (5e-5, 2e-3),
            "rod ends 0.02-0.1 mm, worn clevis 0.1-0.5 mm: the whole play",
            angular_unit="rad",
        ),
    ),
    cut="gas",
    reveals=("position",),
    needs=("pressure_1",),
    mistaken_for=("transmission_compliance", "valve_deadband", "dead_volume", "stribeck_friction"),
    experiment="seal the chambers and reverse a small load: the width of the play does not depend on the load",
    convention=(
        "gap is the whole play from one contact to the other, at the rod [m], or at the joint where it is "
        "given for one."
    ),
    valid="one gap between two stiff contacts with nothing of weight between them; the knock itself lasts a few time steps.",
    signature="a flat stretch at every reversal of load, with a knock at its end",
    identification=Identification(
        jerky=True, starts=((2e-4,), (5e-4,), (1e-3,)), least={"gap": 4e-5},
        applicability=Applicability(moving=True, known_at_joint="drive_gap")
    ),
)


@kernel
def stretch(p, deflection: float) -> float:
    """Return what is left of a deflection behind the play [m]."""
    half = 0.5 * p.gap
    return deflection - min(max(deflection, -half), half)
