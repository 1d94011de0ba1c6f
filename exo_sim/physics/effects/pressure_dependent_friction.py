"""Seals that press harder the higher the pressure."""

from __future__ import annotations

from exo_sim.physics.compiled import kernel
from exo_sim.physics.effects.declaration import Effect, Parameter

EFFECT = Effect(
    name="pressure_dependent_friction",
    places=("cylinder",),
    question="Does dry friction grow with the pressure in the chambers?",
    says="Seal friction grows with chamber pressure.",
    parameters=(
        Parameter("coefficient", "m^2", 0.0, 1e-2, (5e-6, 1e-4), "mu pi D w, 0.5-5 N a bar (engineering estimate)"),
    ),
    cut="motion",
    reveals=("position", "force"),
    needs=("pressure_1",),
    mistaken_for=("coulomb_friction", "viscous_friction"),
    experiment="slow triangles at 2 and at 6 bar mean pressure",
    convention="force = coefficient x (gauge pressure 1 + gauge pressure 2), in addition to other dry friction.",
    signature="the loop of force against velocity is fatter at high pressure",
)


@kernel
def level(p, gauge_1: float, gauge_2: float) -> float:
    """Return the dry friction from both chambers' pressures above the atmosphere [N]."""
    return p.coefficient * (max(gauge_1, 0.0) + max(gauge_2, 0.0))
