"""Where MuJoCo and the gas meet, compiled: lengths and positions in, rod forces and friction out."""

from __future__ import annotations

from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.forces import joint_forces, rod_forces
from exo_sim.physics.plant import FOLLOWED, step
from exo_sim.simulation.mujoco_calls import call, read_time
from exo_sim.simulation.views import GAS_TIME, MUJOCO_TIME, STEP, STEPPED

#: What `catch_up` returns where MuJoCo's clock is neither where the gas is nor one step further, or stood still over a step.
OUT_OF_STEP = -1
#: Share of a step within which two clocks agree; sums of steps round by far less.
CLOCK_SLACK = 1e-3


@inlined_kernel
def moment_arm(actuator, dof, mechanics):
    """Return dlength/dq of one actuator for one degree of freedom from MuJoCo's sparse rows; 0 where it has none."""
    arm = 0.0
    start = mechanics.moment_rowadr[actuator]
    for j in range(start, start + mechanics.moment_rownnz[actuator]):
        if mechanics.moment_colind[j] == dof:
            arm = mechanics.actuator_moment[j]
    return arm


@inlined_kernel
def freshen_levers(mechanics, plant):
    """Set each cylinder's lever at the joint that it drives."""
    for i in range(len(plant.cylinders)):
        plant.cylinders[i].arm = moment_arm(plant.actuators[i], plant.driven[i], mechanics)


@inlined_kernel
def compute_forces(mechanics, plant):
    """Write the rod forces into MuJoCo's `ctrl` and what the joints' own friction adds into its applied forces.

    `felt` keeps what was added last, so that forces from others in `qfrc_applied` stay.
    """
    for i in range(len(plant.cylinders)):
        plant.x[i] = mechanics.actuator_length[plant.actuators[i]] - plant.retracted[i]
        plant.v[i] = mechanics.actuator_velocity[plant.actuators[i]]
    rod_forces(plant.world[0], plant.cylinders, plant.vector, plant.x, plant.v, plant.force)
    for i in range(len(plant.cylinders)):
        mechanics.ctrl[plant.actuators[i]] = plant.force[i]
    m = len(plant.joints)
    if m > 0:
        for i in range(m):
            plant.q[i] = mechanics.qpos[plant.addresses[i]]
            plant.qd[i] = mechanics.qvel[plant.dofs[i]]
        joint_forces(plant.joints, plant.vector[plant.vector.size - m :], plant.q, plant.qd, plant.own)
        for i in range(m):
            mechanics.qfrc_applied[plant.dofs[i]] += plant.own[i] - plant.felt[i]
            plant.felt[i] = plant.own[i]


@inlined_kernel
def advance_gas(mechanics, plant):
    """Move the gas on over the step that MuJoCo has just taken, under `command`; return what became of it (`physics.plant.step`).

    x and q become where it ended; where it was refused they stay.
    """
    for i in range(len(plant.cylinders)):
        plant.x1[i] = mechanics.actuator_length[plant.actuators[i]] - plant.retracted[i]
    for i in range(len(plant.joints)):
        plant.q1[i] = mechanics.qpos[plant.addresses[i]]
    became = step(
        plant.world[0], plant.cylinders, plant.joints, plant.vector, plant.history, plant.x, plant.x1, plant.q, plant.q1, plant.command,
        plant.clock[STEP], plant.work, plant.scratch,
    )  # fmt: skip
    if became == FOLLOWED:
        for i in range(len(plant.cylinders)):
            plant.x[i] = plant.x1[i]
        for i in range(len(plant.joints)):
            plant.q[i] = plant.q1[i]
    return became


@inlined_kernel
def catch_up(mechanics, plant):
    """Bring the gas up to MuJoCo's clock; do nothing where it is there already. Return what became of it."""
    read_time(mechanics.get_state, mechanics.model, mechanics.data, plant.clock.ctypes.data + 8 * MUJOCO_TIME)
    step_length = plant.clock[STEP]
    ahead = plant.clock[MUJOCO_TIME] - plant.clock[GAS_TIME]
    became = FOLLOWED
    if abs(ahead - step_length) <= CLOCK_SLACK * step_length:
        became = advance_gas(mechanics, plant)
        if became == FOLLOWED:
            plant.clock[GAS_TIME] = plant.clock[MUJOCO_TIME]
    elif not abs(ahead) <= CLOCK_SLACK * step_length or plant.clock[STEPPED] != 0.0:
        became = OUT_OF_STEP
    return became


@inlined_kernel
def coupled_step(mechanics, plant):
    """Take one coupled step; return what became of the gas. Where it was refused, MuJoCo's step is left half done."""
    call(mechanics.step1, mechanics.model, mechanics.data)
    became = catch_up(mechanics, plant)
    if became == FOLLOWED:
        if plant.turning[0] != 0:
            freshen_levers(mechanics, plant)
        compute_forces(mechanics, plant)
        call(mechanics.step2, mechanics.model, mechanics.data)
        plant.clock[STEPPED] = 1.0
    return became
