"""The machine along its reference motion: what each phase of the cycle needs of joints, ground and straps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import SAMPLES, Motion
from exo_sim.machine.person import Person, segment_poses
from exo_sim.machine.straps import StrapSet

if TYPE_CHECKING:
    import mujoco

#: Phases at which a stride or repetition is looked at, evenly spaced, and which samples of a motion these are; a cycle of several strides
#: has so many of each.
PHASES = 64
PICK = slice(0, None, SAMPLES // PHASES)
CONTACTS = ("heel_l", "toe_l", "heel_r", "toe_r")


@dataclass(frozen=True)
class MachineDynamics:
    """Along one cycle, n = PHASES for each stride of it. Generalised coordinates in the order of the model's joints (torso x, z, pitch;
    hip, knee, ankle).

    Attributes:
        required: Generalised force that the motion needs from actuators, ground and straps together, (n, 9).
        contact: Jacobian of each of `CONTACTS`, x and z rows, (n, 4, 2, 9).
        pressure: Jacobian of the point under each of the machine's feet at the centre of pressure, (n, 2, 2, 9).
        inertia: Mass matrix, (n, 9, 9).
        tip: Place of each contact, ahead and above the ground there, (n, 4, 2).
        tip_velocity: Its velocity in the reference motion, along a slope and away from it, (n, 4, 2).
        mass_centre: Place of the whole machine's mass centre, (n, 2).
        pressure_point: Place of the centre of pressure, (n, 2, 2).
        strap: Jacobian of each strap's point, rows across and along the segment, (n, straps, 2, 9).
        strap_direction: Those two directions in space, (n, straps, 2, 2).
        poses: The person's segments, (n, 7, 6).
        mass: Of the whole machine [kg].
    """

    required: NDArray[np.float64]
    contact: NDArray[np.float64]
    pressure: NDArray[np.float64]
    inertia: NDArray[np.float64]
    tip: NDArray[np.float64]
    tip_velocity: NDArray[np.float64]
    mass_centre: NDArray[np.float64]
    pressure_point: NDArray[np.float64]
    strap: NDArray[np.float64]
    strap_direction: NDArray[np.float64]
    poses: NDArray[np.float64]
    mass: float


def along(model: mujoco.MjModel, motion: Motion, person: Person, straps: StrapSet) -> MachineDynamics:
    """Place the machine on the motion at every phase and ask MuJoCo for inverse dynamics and Jacobians."""
    import mujoco

    data = mujoco.MjData(model)
    flags = model.opt.disableflags
    model.opt.disableflags = flags | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    rate, ground = 1.0 / motion.period, motion.ground
    root = model.body("torso").id
    foot = [model.body(f"foot_{side}").id for side in "lr"]
    tips = [model.geom(name) for name in CONTACTS]
    place = model.site_pos[[model.site(f"foot_{side}").id for side in "lr"]]
    sole = np.reshape([tip.pos[0] for tip in tips], (2, 2))
    nv, n_straps = model.nv, len(straps.names)
    samples = range(len(motion.position))[PICK]
    n = len(samples)
    required, inertia = np.empty((n, nv)), np.empty((n, nv, nv))
    tip_place, tip_velocity = np.empty((n, 4, 2)), np.empty((n, 4, 2))
    contact = np.empty((n, len(CONTACTS), 2, nv))
    pressure = np.empty((n, 2, 2, nv))
    pressure_point = np.empty((n, 2, 2))
    mass_centre = np.empty((n, 2))
    strap, direction = np.empty((n, n_straps, 2, nv)), np.empty((n, n_straps, 2, 2))
    poses = np.empty((n, 7, 6))
    jacobian = np.empty((3, nv))
    lengths = person.lengths()

    def at(point: NDArray[np.float64], body: int) -> NDArray[np.float64]:
        mujoco.mj_jac(model, data, jacobian, None, point, body)
        return jacobian[[0, 2]]

    try:
        for i, sample in enumerate(samples):
            data.qpos[:] = motion.position[sample]
            data.qvel[:] = motion.slope[sample] * rate
            data.qacc[:] = motion.curvature[sample] * rate**2
            mujoco.mj_inverse(model, data)
            required[i] = data.qfrc_inverse
            mujoco.mj_fullM(model, data, inertia[i])
            for j, tip in enumerate(tips):
                centre = data.geom_xpos[tip.id].copy()
                centre[2] -= tip.size[0]
                contact[i, j] = at(centre, foot[j // 2])
                gone = sample / len(motion.position) * motion.advance  # what positions leave out
                below = ground.height(centre[0] + gone) - ground.grade * gone
                tip_place[i, j] = centre[0], centre[2] - below
                tip_velocity[i, j] = contact[i, j] @ data.qvel
                if not ground.tread:
                    tip_velocity[i, j, 1] -= ground.grade * tip_velocity[i, j, 0]
            for j in range(2):
                ahead = np.clip(motion.pressure_centre[sample, j], *sole[j])  # toes that bend are the wearer's
                local = np.array([ahead, place[j, 1], place[j, 2]])
                point = data.xpos[foot[j]] + data.xmat[foot[j]].reshape(3, 3) @ local
                pressure[i, j], pressure_point[i, j] = at(point, foot[j]), point[[0, 2]]
            mass_centre[i] = data.subtree_com[root][[0, 2]]
            segment_poses(data.qpos, data.qvel, lengths, poses[i])
            for j in range(n_straps):
                body = straps.body[j]
                point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ straps.local[j]
                angle = poses[i, straps.segment[j], 2]
                turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
                direction[i, j] = turn
                strap[i, j] = turn @ at(point, body)
    finally:
        model.opt.disableflags = flags
    return MachineDynamics(
        required=required,
        contact=contact,
        pressure=pressure,
        inertia=inertia,
        tip=tip_place,
        tip_velocity=tip_velocity,
        mass_centre=mass_centre,
        pressure_point=pressure_point,
        strap=strap,
        strap_direction=direction,
        poses=poses,
        mass=float(model.body_subtreemass[root]),
    )
