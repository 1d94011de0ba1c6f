"""How a machine answers to its joint torques along a walk: MuJoCo's own step, linearised where it was taken.

A machine on the ground with a load on its back is an inverted pendulum between straps: what holds it up, the ground's force and the weight,
also tips it over, and half of what straps hold is that. So its answer follows from the walk itself, not from the reference alone: every
step is taken again from where it began, with each coordinate, rate and torque a little otherwise. Steps in a row, the last followed by the
first, give what a steady change of the torques over the cycle does to a steady walk.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control import machine_dynamics
from exo_sim.control.walk_response import WalkResponse
from exo_sim.machine.person import COORDINATES
from exo_sim.machine.straps import StrapSet, pull
from exo_sim.physics.compiled import kernel
from exo_sim.simulation.mujoco_calls import call
from exo_sim.simulation.views import mechanics
from exo_sim.simulation.walk import JOINTS, Walk

Array = NDArray[np.float64]

#: By how much a coordinate [m, rad], a rate [m/s, rad/s] and a torque [N m] are changed. Contact is smooth over such a way; the solver
#: leaves 1e-8 of an acceleration.
_PLACE, _RATE, _TORQUE = 1e-6, 1e-5, 1e-2
#: A tip that comes down more slowly than this [m/s] meets the ground as if it came so fast.
_SLOWEST = 0.02
#: What a contact changes the state by in a step, at the least [m, rad, m/s, rad/s].
_TOUCH = 1e-6
_NAMES = ("torso_x", "torso_z", *COORDINATES[2:])


def linearised(walk: Walk, driven: list[int]) -> WalkResponse:
    """Linearise the last whole cycle of a walk of a wearer whose motion is prescribed.

    Args:
        walk: At least a cycle long.
        driven: Which of the six joints have a torque.
    """
    period = walk.motion.period
    n = round(period / walk.step)
    end = round(np.floor(walk.time[-1] / period + 1e-6) * period / walk.step) - walk.first
    rows = slice(end - n, end)
    place, rate = (_columns(walk, [f"{name}.{what}" for name in _NAMES], rows) for what in ("position", "velocity"))
    torque = _columns(walk, [f"{name}.torque" for name in JOINTS], rows)
    model, straps, count, width = walk.model, walk.straps, len(walk.straps.names), 2 * len(_NAMES)
    data = mujoco.MjData(model)
    tips = np.array([model.geom(name).id for name in machine_dynamics.CONTACTS])
    by_state, by_torque, by_strap = np.empty((n, width, width)), np.empty((n, width, len(driven))), np.empty((n, 2 * count, width))
    by_tip = np.empty((n, len(tips), width))
    scratch = _Scratch(
        np.zeros((count, 2)), np.zeros((count, 2)), np.zeros(count), np.zeros((7, 3)), np.zeros(width), np.zeros(width),
        np.zeros(2 * count), np.zeros(2 * count),
    )  # fmt: skip
    _linearise(
        mechanics(model, data), _Bodies.of(model, data), _Straps.of(straps), model.body("torso").id, tips,
        np.ascontiguousarray(walk.poses[rows]), place, rate, torque, np.array([3 + joint for joint in driven]), scratch, by_state,
        by_torque, by_strap, by_tip,
    )  # fmt: skip
    touched = np.abs(by_tip).max(axis=2) > _TOUCH
    for k, tip in zip(*np.nonzero(touched & ~np.roll(touched, 1, axis=0))):
        by_state[k] += np.outer(by_tip[k, tip] / walk.step, _sooner(walk, data, place[k], rate[k], int(tips[tip])))
    return WalkResponse(walk.time[rows] / period, by_state, by_torque, by_strap)


def _columns(walk: Walk, names: list[str], rows: slice) -> Array:
    return np.stack([walk.columns[name][rows] for name in names], axis=1)


def _sooner(walk: Walk, data: mujoco.MjData, place: Array, rate: Array, tip: int) -> Array:
    """Return by how much sooner a tip that comes down meets the ground for each coordinate and rate [s], shape (18,)."""
    model, ground = walk.model, walk.motion.ground
    data.qpos[:], data.qvel[:] = place, rate
    mujoco.mj_fwdPosition(model, data)
    point = data.geom_xpos[tip].copy()
    point[2] -= model.geom_size[tip, 0]
    jacobian = np.empty((3, len(place)))
    mujoco.mj_jac(model, data, jacobian, None, point, int(model.geom_bodyid[tip]))
    slope = 0.0 if ground.tread else ground.grade
    rises = jacobian[2] - slope * jacobian[0]
    return np.concatenate([-rises / max(-float(rises @ rate), _SLOWEST), np.zeros(len(rate))])


class _Bodies(NamedTuple):
    """Views of MuJoCo's data beside `views.Mechanics`."""

    xpos: Array
    xmat: Array
    xipos: Array
    cvel: Array
    subtree_com: Array
    xfrc_applied: Array
    warm: Array
    touches: NDArray[np.int32]

    @classmethod
    def of(cls, model: mujoco.MjModel, data: mujoco.MjData) -> _Bodies:
        return cls(
            data.xpos, data.xmat, data.xipos, data.cvel, data.subtree_com, data.xfrc_applied, data.qacc_warmstart, model.geom_contype
        )


class _Straps(NamedTuple):
    """A `StrapSet` as the kernel takes it."""

    body: NDArray[np.int64]
    local: Array
    segment: NDArray[np.int64]
    anchor: Array
    stiffness: Array
    damping: Array
    least: Array

    @classmethod
    def of(cls, straps: StrapSet) -> _Straps:
        return cls(straps.body, straps.local, straps.segment, straps.anchor, straps.stiffness, straps.damping, straps.least)


class _Scratch(NamedTuple):
    """What a step writes: of straps the forces, what `pull` remembers and power; wrenches; the next state and strap forces, and others."""

    force: Array
    motion: Array
    power: Array
    wrench: Array
    next: Array
    other: Array
    held: Array
    otherwise: Array


@kernel
def _step(place, rate, torque, poses, root, mech, bodies, straps, scratch, after, held):
    """Take a step from coordinates and rates, with torques of the joints; write the state after it, and strap forces before it."""
    for j in range(9):
        mech.qpos[j], mech.qvel[j] = place[j], rate[j]
    call(mech.step1, mech.model, mech.data)
    pull(
        poses, bodies.xpos, bodies.xmat, bodies.xipos, bodies.cvel, bodies.subtree_com[root],
        straps.body, straps.local, straps.segment, straps.anchor, straps.stiffness, straps.damping, straps.least,
        bodies.xfrc_applied, scratch.force, scratch.motion, scratch.power, scratch.wrench,
    )  # fmt: skip
    for j in range(6):
        mech.qfrc_applied[3 + j] = torque[j]
    call(mech.step2, mech.model, mech.data)
    for j in range(9):
        after[j], after[9 + j] = mech.qpos[j], mech.qvel[j]
    for i in range(straps.body.size):
        angle = poses[straps.segment[i], 2]
        cosine, sine = math.cos(angle), math.sin(angle)
        x, z = scratch.force[i, 0], scratch.force[i, 1]
        held[2 * i], held[2 * i + 1] = cosine * x + sine * z, cosine * z - sine * x


@kernel
def _linearise(mech, bodies, straps, root, tips, poses, place, rate, torque, driven, scratch, by_state, by_torque, by_strap, by_tip):
    """Fill `WalkResponse` from what a walk began each step with: rows of poses, coordinates, rates and joint torques.

    `by_tip`, shape (n, tips, 18), gets what touching the ground with each tip did to the state after the step.
    """
    warm = np.zeros(bodies.warm.size)
    for k in range(place.shape[0]):
        _step(place[k], rate[k], torque[k], poses[k], root, mech, bodies, straps, scratch, scratch.next, scratch.held)
        warm[:] = bodies.warm
        for j in range(tips.size):
            usually = bodies.touches[tips[j]]
            bodies.touches[tips[j]] = 0
            bodies.warm[:] = warm
            _step(place[k], rate[k], torque[k], poses[k], root, mech, bodies, straps, scratch, scratch.other, scratch.otherwise)
            bodies.touches[tips[j]] = usually
            by_tip[k, j] = scratch.next - scratch.other
        for j in range(18 + driven.size):
            moved = _PLACE if j < 9 else _RATE if j < 18 else _TORQUE
            values = place if j < 9 else rate if j < 18 else torque
            at = j if j < 9 else j - 9 if j < 18 else driven[j - 18] - 3
            usual = values[k, at]
            values[k, at] = usual + moved
            bodies.warm[:] = warm
            _step(place[k], rate[k], torque[k], poses[k], root, mech, bodies, straps, scratch, scratch.other, scratch.otherwise)
            values[k, at] = usual
            for i in range(18):
                off = (scratch.other[i] - scratch.next[i]) / moved
                if j < 18:
                    by_state[k, i, j] = off
                else:
                    by_torque[k, i, j - 18] = off
            if j < 18:
                for i in range(by_strap.shape[1]):
                    by_strap[k, i, j] = (scratch.otherwise[i] - scratch.held[i]) / moved
