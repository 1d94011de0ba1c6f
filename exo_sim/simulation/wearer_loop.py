"""What a torque-driven wearer logs at every step, and the compiled loop of one without the machine."""

from __future__ import annotations

from exo_sim.control import wearer_torques
from exo_sim.physics.compiled import borrow, inlined_kernel, kernel
from exo_sim.simulation.mujoco_calls import call

#: Numbers that are logged of the wearer at each step, those of `wearer_log.layout`.
COUNT = 42


@inlined_kernel
def log_before(row, qpos, qvel, mover):
    """Write where the wearer is, and what moves him; MuJoCo's step moves him on."""
    for j in range(11):
        row[j], row[11 + j], row[22 + j] = qpos[mover.dofs[j]], qvel[mover.dofs[j]], mover.applied[j]


@inlined_kernel
def log_after(row, qvel, sensordata, qfrc_constraint, qfrc_passive, dof_damping, ground, mover):
    """Write what the ground did to the wearer in MuJoCo's step (mean power); add what springs and dampers of joints give to the torques."""
    at = 33
    for foot in range(2):
        first = ground[foot]
        row[at], row[at + 1] = -sensordata[first], -sensordata[first + 2]
        row[at + 2], row[at + 3] = sensordata[first + 3], sensordata[first + 5]
        at += 4
    row[at] = 0.0
    for j in range(11):
        dof = mover.dofs[j]
        mean = 0.5 * (row[11 + j] + qvel[dof])
        row[at] += qfrc_constraint[dof] * mean
        if j >= 9:
            row[22 + j] += qfrc_passive[dof] + dof_damping[dof] * (row[11 + j] - qvel[dof])
        elif j >= 3:
            row[22 + j] -= dof_damping[dof] * qvel[dof]


@kernel
def run(first, count, dt, period, advance, step1, step2, model, data, qpos, qvel, qfrc_applied, sensordata, qfrc_constraint, qfrc_passive,
        dof_damping, position, slope, share, lengths, ground, q, v, poses, wrench, mover, log):  # fmt: skip
    """Take `count` steps of a wearer without the machine, the first being number `first`; row i of `log` is of step first + i."""
    mover = borrow(mover)
    for k in range(first, first + count):
        row = log[k - first]
        call(step1, model, data)
        wearer_torques.see(qpos, qvel, q, v, lengths, poses, mover)
        wearer_torques.ask(k * dt / period, period, advance, 0.0, position, slope, share, q, v, poses, lengths, mover)
        wearer_torques.apply(poses, wrench, qfrc_applied, mover)
        log_before(row, qpos, qvel, mover)
        call(step2, model, data)
        log_after(row, qvel, sensordata, qfrc_constraint, qfrc_passive, dof_damping, ground, mover)
