"""Dry friction of one size."""

from __future__ import annotations

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.terms import DRY_FRICTION

EFFECT = Effect(
    name="coulomb_friction",
    places=("cylinder", "joint"),
    family="friction",
    question="Does force differ by a constant between the two directions of slow motion?",
    says="Dry friction of constant size resists motion.",
    parameters=(Parameter("force", "N", 0.0, 1e5, (1.0, 60.0), "4-40 N for 16-50 mm bores", angular_unit="N*m"),),
    cut="motion",
    reveals=("position", "force"),
    mistaken_for=("pressure_dependent_friction", "asymmetric_friction", "stribeck_friction", "valve_deadband"),
    experiment="slow triangles at two mean pressures",
    convention=(
        "force is one direction's; the loop between both directions is twice as high. On a turning joint the "
        "key may be written torque."
    ),
    valid="the seals rub at one level, whatever speed, pressure, place, direction or time at rest.",
    signature="pressure difference against position is a loop of constant height; the piston sticks at reversals",
    # A dip that the motion does not show apart counts in the level. 13 levels were found without one on machines of draws X577 to X717,
    # 11 of which have one: off by 0.31 to -0.01 of them, 0.11 at the median, 12 of 13 to the larger side; 9 of 13 intervals held.
    identification=Identification(resists=1.0, prevalence=0.6, open_by={"force": (0.85, 1.0)}, closed_beside="stribeck_friction"),
)


@DRY_FRICTION.of(EFFECT)
def level(p, motion):
    """Return the dry friction [N or N m]."""
    return p.force
