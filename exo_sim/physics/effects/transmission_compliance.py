"""A mount, strap or drive that gives under load."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.identification import Applicability, Twins

#: Contacts of hard parts give less than this [N/m]: those of printed lugs and bushes, the softest, 1e5 to 1e6 (see the range below).
SOFTEST_CONTACT = 1e5

EFFECT = Effect(
    name="transmission_compliance",
    places=("cylinder", "joint"),
    family="transmission",
    question="Does the joint lag the piston in proportion to the force between them?",
    says="The transmission between piston and joint is elastic.",
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            1e2,
            1e10,
            (1e4, 1e7),
            "steel linkage 1e6-1e7, printed 1e5-1e6, strap 5e3-3e4 N/m",
            angular_unit="N*m/rad",
        ),
    ),
    cut="gas",
    reveals=("position",),
    needs=("pressure_1",),
    mistaken_for=("dead_volume", "backlash", "payload_mass", "presliding"),
    experiment="seal the chambers and load the joint at two pressures: the gas part of the give scales with pressure",
    convention=(
        "on a cylinder, stiffness along the rod; on a joint, of its drive. Both together are in series. "
        "Position is recorded on the joint's side."
    ),
    valid="what gives has neither mass nor damping, and the piston weighs little against what it moves.",
    signature="chambers behave as if larger under load; a second resonance",
    identification=Identification(
        starts=((3e5,), (3e4,)),
        applicability=Applicability(moving=True, known_at_joint="drive_stiffness"),
        open_by={"stiffness": (0.96, 1.01)},  # mass and damping between piston and joint stiffen it where it moves fast
        twins=Twins(unseen=("backlash",), unseen_from={"stiffness": SOFTEST_CONTACT}),
    ),
)


@kernel
def present(p) -> bool:
    """Return whether the transmission gives at all."""
    return p.stiffness > 0.0
