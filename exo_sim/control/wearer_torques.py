"""The joint torques of a wearer who is a body: what the reference motion asks, and what brings him back to it.

Three parts add up at hips, knees and ankles (the foot in the air is put farther ahead where the pelvis is faster than its path, so that it
slows down, and nearer where it is slower):

- the moments that he plans, also at the toes (`wearer_plan.py`);
- springs and dampers towards the angles of the reference: muscles and reflexes;
- what brings the pelvis back to its path and the trunk to its lean through the legs that stand: a wrench at the pelvis, shared as the legs
  share the load, as joint torques of legs without mass (virtual model control: Pratt, Chew, Torres, Dilworth and Pratt 2001, International
  Journal of Robotics Research 20:129). A leg pushes ahead no harder than its sole can hold: an ankle that asks for more lifts heel or toes
  off the ground. Where the machine's shoe holds the foot as well there is no such limit.

Nothing else holds the wearer but weak springs at the pelvis. Their force is no muscle's: it is the residual.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import look_up, reference
from exo_sim.machine.person import REFERENCE_HEIGHT, Person, segment_poses
from exo_sim.physics.compiled import inlined_kernel

Array = NDArray[np.float64]

#: Springs [N m/rad] and dampers [N m s/rad] of hip, knee and ankle of a body of 75 kg and 1.70 m; others in proportion to mass and height.
#: An ankle that walks has 86 to 407 N m/rad and 1.2 to 6 N m s/rad (1.14 to 5.43 and 0.016 to 0.080 a kilogram: Ficanha, Ribeiro, Knop and
#: Rastgaar 2018, Journal of Medical Devices 12:011010). With dampers of 50, 30 and 15 a foot was driven on when its ball met the ground and
#: a knee did not give: the first peak of the force was 1.25 of the weight (1.14 with these and other soles, recorded 1.10).
#: Of some 70 sets most leave no such peak; this one alone of eight starts and stops with `exo` and `exo_250_psi` and costs less than the
#: backpack with causal control on straps half as stiff and with a phase that is early (with the steps of that day: see `FASTER`). Softer
#: hips fall where they start and stop.
STIFFNESS, DAMPING = (600.0, 400.0, 300.0), (35.0, 15.0, 8.0)
#: Of the pelvis ahead and up [N/m], [N s/m] and of the trunk [N m/rad], through the legs that stand: critically damped for the whole body.
#: Of 2000, 1500 and 1000 N/m ahead with 775 N s/m, and 1000 with 550, a longer right step left 30, 28, 27 and 20 N of residual (causal
#: control, the foot put ahead by `FASTER` alone). With 1500, 2000 and 2500 N m/rad he fell under 2, none and 1 of three payloads in eight
#: walks from rest to rest (`exo`); with 2000 and 220 or 300 N m s/rad he fell in the seventh with 20 kg.
PELVIS_STIFFNESS, PELVIS_DAMPING = (1000.0, 15000.0, 2000.0), (548.0, 2100.0, 270.0)
#: The residual: weak springs and dampers between pelvis and reference.
HELD_STIFFNESS, HELD_DAMPING = (500.0, 500.0, 600.0), (50.0, 50.0, 60.0)
_MASS = 75.0
#: Where the foot in the air is put. For each metre a second that the pelvis is faster than its path, so many metres farther ahead [s], what
#: a pendulum of a leg's length asks: its time is 0.3 s (Hof 2008, Human Movement Science 27:112; people do so: Bruijn and van Dieen 2018,
#: Journal of the Royal Society Interface 15:20170816); a speed that is off by less than this [m/s] is not answered: it is of every step,
#: and drives the foot into the ground (first peak of the force 1.175 of the weight without, 1.149 with it; recorded 1.105). For each metre
#: that the pelvis is ahead of its path, so many metres behind [1]: part of the way back to where the reference has the foot. And the most
#: [m]. Before, the foot was put 0.1 s times the speed behind, and 0.6 of the way back: with causal control a longer right step then took
#: 1.22 of the backpack's work with 81 N of residual (0.88 and 21 N now), straps half as stiff 1.03 with 32 N (0.96 and 17 N), hips less
#: flexed left 41 N (13 N), and other gains of the controller made him fall.
FASTER, ALLOWED, BACK, MOST_MOVED = 0.3, 0.02, 0.2, 0.15
#: Damping of the swing leg's inverse kinematics [m^2].
_REACH = 0.004
#: More than any ankle gives [N m]; levers shorter than this carry no moment [m].
_NO_LIMIT, _SHORT = 1e9, 1e-3


class Mover(NamedTuple):
    """What moves the wearer in the compiled loop.

    Attributes:
        dofs: Places of `wearer_body.JOINTS` in MuJoCo's positions and velocities, shape (11,); none where the motion is prescribed.
        torque: Planned, the first row repeated behind the last, shape (n + 1, 8).
        room: As `wearer_plan.Plan` has it, the first row repeated behind the last, shape (n + 1, 4).
        stiffness, damping: Of hips, knees, ankles, shape (6,).
        pelvis_stiffness, pelvis_damping, held_stiffness, held_damping: Of the pelvis by the legs, and by the residual, shape (3,).
        wanted, wanted_rate: The reference now, shape (9,).
        planned: Torques now, shape (8,).
        spare: What the ankles may give more now, shape (4,).
        carried: Share of each leg now, shape (2,).
        applied: Residual at the pelvis ahead, up and turning, and the torques of the joints, shape (11,).
        load: Of the straps, by coordinate, shape (9,).
        placement: `FASTER`, `ALLOWED`, `BACK`, `MOST_MOVED`, shape (4,).
    """

    dofs: NDArray[np.int64]
    torque: Array
    room: Array
    stiffness: Array
    damping: Array
    pelvis_stiffness: Array
    pelvis_damping: Array
    held_stiffness: Array
    held_damping: Array
    wanted: Array
    wanted_rate: Array
    planned: Array
    spare: Array
    carried: Array
    applied: Array
    load: Array
    placement: Array


def mover(
    person: Person, carried: float = 0.0, torque: Array | None = None, dofs: NDArray[np.int64] | None = None, room: Array | None = None
) -> Mover:
    """Return what moves a person with a payload [kg] by planned torques; without those, what moves nobody.

    Args:
        person: Who moves.
        carried: The payload, on the own back or on the machine's: springs and dampers grow with it.
        torque: As `wearer_plan.Plan` has it.
        dofs: As in `Mover`.
        room: As `wearer_plan.Plan` has it; None where more than the own soles bears the feet.
    """
    moves = torque if torque is not None else np.zeros((1, 8))
    limits = room if room is not None else np.full((len(moves), 4), _NO_LIMIT)
    grown = (person.mass + carried) / _MASS
    turning = grown * (person.height / REFERENCE_HEIGHT) ** 2
    of_pelvis = np.array([grown, grown, turning])
    return Mover(
        np.empty(0, np.int64) if dofs is None else dofs, np.ascontiguousarray(np.concatenate([moves, moves[:1]])),
        np.ascontiguousarray(np.concatenate([limits, limits[:1]])),
        turning * np.array(STIFFNESS * 2), turning * np.array(DAMPING * 2), of_pelvis * PELVIS_STIFFNESS, of_pelvis * PELVIS_DAMPING,
        np.array(HELD_STIFFNESS), np.array(HELD_DAMPING), np.zeros(9), np.zeros(9), np.zeros(8), np.zeros(4), np.zeros(2), np.zeros(11),
        np.zeros(9), np.array([FASTER, ALLOWED, BACK, MOST_MOVED]),
    )  # fmt: skip


def dampen(model: mujoco.MjModel, it: Mover) -> None:
    """Let MuJoCo damp the wearer's joints: implicitly, since a swinging foot is light for the damping of an ankle."""
    damping = model.dof_damping if model.dof_damping.ndim == 1 else model.dof_damping[:, 0]
    damping[it.dofs[3:9]] = it.damping


@inlined_kernel
def see(qpos, qvel, q, v, lengths, poses, mover):
    """Read where the wearer is: q, v (9,) and the poses of his segments (7, 6) are written."""
    for j in range(9):
        q[j], v[j] = qpos[mover.dofs[j]], qvel[mover.dofs[j]]
    segment_poses(q, v, lengths, poses)


@inlined_kernel
def _put_ahead(way, first, lengths, wanted):
    """Move an ankle ahead [m] and as high as it is, the foot's pitch unchanged, by hip, knee and ankle that begin at `first`."""
    thigh = wanted[2] + wanted[first]
    shank = thigh + wanted[first + 1]
    knee_x, knee_z = lengths[1] * math.cos(shank), lengths[1] * math.sin(shank)
    hip_x, hip_z = knee_x + lengths[0] * math.cos(thigh), knee_z + lengths[0] * math.sin(thigh)
    # damped least squares: a stretched leg reaches no farther
    xx, xz, zz = hip_x * hip_x + knee_x * knee_x + _REACH, hip_x * hip_z + knee_x * knee_z, hip_z * hip_z + knee_z * knee_z + _REACH
    scale = way / (xx * zz - xz * xz)
    by_hip, by_knee = scale * (zz * hip_x - xz * hip_z), scale * (zz * knee_x - xz * knee_z)
    wanted[first] += by_hip
    wanted[first + 1] += by_knee
    wanted[first + 2] -= by_hip + by_knee


@inlined_kernel
def _step_farther(off, fast, placement):
    """Return how much farther ahead of the pelvis the foot in the air is put [m] where the pelvis is ahead of its path and faster."""
    fast -= min(max(fast, -placement[1]), placement[1])
    ahead = placement[0] * fast - placement[2] * off
    return min(max(ahead, -placement[3]), placement[3])


@inlined_kernel
def _held_by_sole(part, leg, push, poses, mover):
    """Return what a leg that carries a share pushes the pelvis ahead with [N] so that the centre of pressure stays in its sole."""
    row = 3 + 3 * leg
    x, z = poses[row, 0] - poses[0, 0], poses[row, 1] - poses[0, 1]
    if part * abs(z) < _SHORT:
        return push[0]
    asked = -part * (push[2] - x * push[1] + z * push[0])
    given = min(max(asked, -mover.spare[2 * leg]), mover.spare[2 * leg + 1])
    return push[0] - (given - asked) / (part * z)


@inlined_kernel
def ask(cycles, period, advance, climb, position, slope, share, q, v, poses, lengths, mover):
    """Write the torques of now, and the residual, into `mover.applied`."""
    reference(cycles, period, advance, climb, position, slope, mover.wanted, mover.wanted_rate)
    look_up(cycles, mover.torque, mover.planned)
    look_up(cycles, mover.room, mover.spare)
    look_up(cycles, share, mover.carried)
    push = mover.load  # at the pelvis, by the legs
    for j in range(3):
        off, slow = mover.wanted[j] - q[j], mover.wanted_rate[j] - v[j]
        push[j] = mover.pelvis_stiffness[j] * off + mover.pelvis_damping[j] * slow
        mover.applied[j] = mover.held_stiffness[j] * off + mover.held_damping[j] * slow
    ahead = _step_farther(q[0] - mover.wanted[0], v[0] - mover.wanted_rate[0], mover.placement)
    for leg in range(2):
        part = mover.carried[leg]
        forward = _held_by_sole(part, leg, push, poses, mover)
        _put_ahead((1.0 - part) * ahead, 3 + 3 * leg, lengths, mover.wanted)
        for k in range(3):
            row, j = 1 + 3 * leg + k, 3 * leg + k
            x, z = poses[row, 0] - poses[0, 0], poses[row, 1] - poses[0, 1]
            by_pelvis = -part * (push[2] - x * push[1] + z * forward)
            by_joint = mover.stiffness[j] * (mover.wanted[3 + j] - q[3 + j])
            by_joint += mover.damping[j] * mover.wanted_rate[3 + j]  # MuJoCo takes the damping of the joint off at the end of the step
            mover.applied[3 + j] = mover.planned[j] + by_pelvis + by_joint
    mover.applied[9], mover.applied[10] = mover.planned[6], mover.planned[7]


@inlined_kernel
def apply(poses, wrench, qfrc_applied, mover):
    """Put torques, residual and what the straps do to the segments, shape (7, 3), into MuJoCo's applied forces."""
    load = mover.load
    load[:] = 0.0
    for s in range(7):
        fx, fz, turning = wrench[s, 0], wrench[s, 1], wrench[s, 2]
        load[0] += fx
        load[1] += fz
        load[2] += turning + (poses[s, 0] - poses[0, 0]) * fz - (poses[s, 1] - poses[0, 1]) * fx
        if s > 0:
            first = 3 * ((s - 1) // 3)
            for k in range((s - 1) % 3 + 1):
                row = 1 + first + k
                load[3 + first + k] += turning + (poses[s, 0] - poses[row, 0]) * fz - (poses[s, 1] - poses[row, 1]) * fx
    for j in range(9):
        qfrc_applied[mover.dofs[j]] = mover.applied[j] + load[j]
    for j in range(9, 11):
        qfrc_applied[mover.dofs[j]] = mover.applied[j]
