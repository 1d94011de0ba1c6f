"""MuJoCo's step with straps on the machine, taken again from where a walk began each with every coordinate, rate and torque otherwise."""

from __future__ import annotations

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.straps import StrapSet, pull
from exo_sim.physics.compiled import kernel
from exo_sim.simulation.mujoco_calls import call

Array = NDArray[np.float64]

#: By how much a coordinate [m, rad], a rate [m/s, rad/s] and a torque [N m] are changed. Contact is smooth over such a way; the solver
#: leaves 1e-8 of an acceleration.
_PLACE, _RATE, _TORQUE = 1e-6, 1e-5, 1e-2


class Bodies(NamedTuple):
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
    def of(cls, model: mujoco.MjModel, data: mujoco.MjData) -> Bodies:
        return cls(
            data.xpos, data.xmat, data.xipos, data.cvel, data.subtree_com, data.xfrc_applied, data.qacc_warmstart, model.geom_contype
        )


class StrapArrays(NamedTuple):
    """A `StrapSet` as the kernel takes it."""

    body: NDArray[np.int64]
    local: Array
    segment: NDArray[np.int64]
    anchor: Array
    stiffness: Array
    damping: Array
    least: Array

    @classmethod
    def of(cls, straps: StrapSet) -> StrapArrays:
        return cls(straps.body, straps.local, straps.segment, straps.anchor, straps.stiffness, straps.damping, straps.least)


class Scratch(NamedTuple):
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
def linearise(mech, bodies, straps, root, tips, poses, place, rate, torque, driven, scratch, by_state, by_torque, by_strap, by_tip):
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
