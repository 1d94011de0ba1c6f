"""Seals that press harder the higher the pressure."""

from __future__ import annotations

from exo_sim.physics.declaration import Effect, Identification, Parameter
from exo_sim.physics.terms import DRY_FRICTION

EFFECT = Effect(
    name="pressure_dependent_friction",
    places=("cylinder",),
    family="friction",
    question="Does dry friction grow with the pressure in the chambers?",
    says="Seal friction grows with chamber pressure.",
    parameters=(
        Parameter("coefficient", "m^2", 0.0, 1e-2, (5e-6, 1e-4), "mu pi D w, 0.5-5 N a bar (engineering estimate)"),
        Parameter("difference", "m^2", 0.0, 1e-2, (5e-6, 1e-4), "as the coefficient; lip seals of the piston", required=False),
    ),
    any_of=(("coefficient",), ("difference",)),
    cut="motion",
    reveals=("position", "force"),
    needs=("pressure_1",),
    mistaken_for=("coulomb_friction", "viscous_friction"),
    experiment="slow triangles at 2 and at 6 bar mean pressure",
    convention=(
        "force = coefficient x (gauge pressure 1 + gauge pressure 2) + difference x |pressure 1 - pressure 2|, in addition to other "
        "dry friction."
    ),
    valid="both seals press alike and in proportion to pressure, whichever chamber has more.",
    signature="the loop of force against velocity is fatter at high pressure",
    identification=Identification(forms=(("coefficient",), ("difference",), ("coefficient", "difference")), prevalence=0.3),
)


@DRY_FRICTION.of(EFFECT)
def level(p, motion):
    """Return the dry friction from both chambers' pressures above the atmosphere, and from their difference [N]."""
    sum_of_both = p.coefficient * (max(motion.gauge_1, 0.0) + max(motion.gauge_2, 0.0))
    return sum_of_both + p.difference * abs(motion.gauge_1 - motion.gauge_2)
