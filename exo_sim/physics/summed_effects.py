"""What all effects together add to the balances of a chamber's gas and of a part in motion."""

from __future__ import annotations

from exo_sim.physics import settling
from exo_sim.physics.declaration import declared
from exo_sim.physics.external_effects_off import check_external_effects
from exo_sim.physics.terms import ACROSS_FLOW, DAMPING, DRY_EXCESS, DRY_FRICTION, HEAT_FLOW, OUTWARD_FLOW, SPRING_FORCE

declared()  # with this every effect has said what it adds
check_external_effects()

outward_flow = OUTWARD_FLOW.total("cylinder")
across_flow = ACROSS_FLOW.total("cylinder")
heat_flow = HEAT_FLOW.total("cylinder")

#: Bounds on how fast a chamber settles by each [1/s].
outward_rate = OUTWARD_FLOW.fastest("cylinder", settling.by_outward_flow)
across_rate = ACROSS_FLOW.fastest("cylinder", settling.by_across_flow)
heat_rate = HEAT_FLOW.fastest("cylinder", settling.by_heat_flow)

piston_dry_friction, joint_dry_friction = DRY_FRICTION.total("cylinder"), DRY_FRICTION.total("joint")
piston_with_excess, joint_with_excess = DRY_EXCESS.in_turn("cylinder"), DRY_EXCESS.in_turn("joint")
piston_damping, joint_damping = DAMPING.total("cylinder"), DAMPING.total("joint")
piston_spring_force, joint_spring_force = SPRING_FORCE.total("cylinder"), SPRING_FORCE.total("joint")
