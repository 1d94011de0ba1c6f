"""Where MuJoCo and the gas meet, compiled: lengths and positions in, rod forces and friction out."""

from __future__ import annotations

from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.pneumatics import joint_forces, rod_forces, step


@kernel
def moment_arm(actuator, dof, moment, counts, starts, dofs):
    """Return dlength/dq of one actuator for one degree of freedom from MuJoCo's sparse rows; 0 where it has none."""
    arm = 0.0
    for j in range(starts[actuator], starts[actuator] + counts[actuator]):
        if dofs[j] == dof:
            arm = moment[j]
    return arm


@inlined_kernel
def compute_forces(
    world, cylinders, joints, vector, actuators, retracted, length, velocity, dofs, addresses, qpos, qvel,
    ctrl, applied, x, v, force, q, qd, own, felt,
):  # fmt: skip
    """Write the rod forces into `ctrl` and what the joints' own friction adds into `applied`.

    `felt` keeps what was added last, so that forces from others in `applied` stay.
    """
    for i in range(len(cylinders)):
        x[i] = length[actuators[i]] - retracted[i]
        v[i] = velocity[actuators[i]]
    rod_forces(world, cylinders, vector, x, v, force)
    for i in range(len(cylinders)):
        ctrl[actuators[i]] = force[i]
    if len(joints) > 0:
        for i in range(len(joints)):
            q[i] = qpos[addresses[i]]
            qd[i] = qvel[dofs[i]]
        joint_forces(joints, vector[vector.size - len(joints) :], q, qd, own)
        for i in range(len(joints)):
            applied[dofs[i]] += own[i] - felt[i]
            felt[i] = own[i]


@inlined_kernel
def advance_gas(
    world, cylinders, joints, vector, history, actuators, retracted, length, addresses, qpos, command, dt,
    x, x1, q, q1, work, scratch,
):  # fmt: skip
    """Move the gas on over the step that MuJoCo has just taken; x and q become where it ended."""
    for i in range(len(cylinders)):
        x1[i] = length[actuators[i]] - retracted[i]
    for i in range(len(joints)):
        q1[i] = qpos[addresses[i]]
    step(world, cylinders, joints, vector, history, x, x1, q, q1, command, dt, work, scratch)
    for i in range(len(cylinders)):
        x[i] = x1[i]
    for i in range(len(joints)):
        q[i] = q1[i]
