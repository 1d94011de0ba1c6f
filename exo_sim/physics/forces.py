"""What the joints feel of cylinders and contacts, and what sensors read, with the joints where they are."""

from __future__ import annotations

from exo_sim.physics import nodes, state
from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.conditions import Motion
from exo_sim.physics.cylinder import rod_force
from exo_sim.physics.effects import unknown
from exo_sim.physics.friction import joint_dry_level, joint_resistance, move_bristle, piston_resistance
from exo_sim.physics.transmission import carried, gives, piston_at


@inlined_kernel
def rod_forces(world, cylinders, state_vector, x, v, force):
    """Write the force of each rod on the joint's side [N], + pushes out: gas, atmosphere, and what resists the piston.

    Args:
        x, v: Transmission length less the retracted one, and its rate, shape (n,).
        force: Result, shape (n,).
    """
    n = len(cylinders)
    total = n * state.INTEGRATED + state.SHARED
    memory = state_vector[total:]
    for i in range(n):
        c = cylinders[i]
        place = i * state.REMEMBERED
        here = memory[place + state.PISTON] if gives(c) else x[i]
        p_1, p_2 = nodes.pressures(world, c, state_vector, i * state.INTEGRATED, here)
        if gives(c):
            z, speed = memory[place + state.BRISTLE], memory[place + state.PISTON_SPEED]
            piston = piston_at(world, c, p_1, p_2, here, x[i], z, speed, 0.0)
            force[i] = carried(c, piston, x[i])
        else:
            motion = Motion(x[i], v[i], memory[place + state.BRISTLE], p_1 - world.atmosphere, p_2 - world.atmosphere)
            push = rod_force(p_1, p_2, c.area_1, c.area_2, world.atmosphere)
            push += unknown.acting(c.unknown, 0, x[i], v[i], p_1, p_2)
            force[i] = push - piston_resistance(c, motion)


@kernel
def sensed_pressures(world, cylinders, state_vector, i: int, x: float) -> tuple[float, float]:
    """Return the absolute pressures that cylinder i's sensors read [Pa], with the joint's side at x.

    The piston may be elsewhere than the joint has it, and the sensors at the valve's end of the hoses.
    """
    c = cylinders[i]
    n = len(cylinders)
    here = state_vector[n * state.INTEGRATED + state.SHARED + i * state.REMEMBERED + state.PISTON] if gives(c) else x
    return nodes.sensed_pressures(world, c, state_vector, i * state.INTEGRATED, here)


@kernel
def joint_forces(joints, bristles, q, qd, force):
    """Write the generalised force that each joint's own friction, spring and drag exert, shape (m,) [N or N m]."""
    for i in range(len(joints)):
        force[i] = -joint_resistance(joints[i], Motion(q[i], qd[i], bristles[i], 0.0, 0.0))
        force[i] += unknown.acting(joints[i].unknown, 0, q[i], qd[i], 0.0, 0.0)


@kernel
def advance_joints(joints, bristles, q0, q1, dt):
    """Move the bristles of the joints on by a step, from q0 to q1, shape (m,)."""
    for i in range(len(joints)):
        speed = (q1[i] - q0[i]) / dt
        level = joint_dry_level(joints[i], Motion(q1[i], speed, bristles[i], 0.0, 0.0))
        bristles[i] = move_bristle(joints[i], bristles[i], speed, level, dt)
