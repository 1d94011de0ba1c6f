"""What the masses of a machine ask for along a motion, and what that on its back asks of it."""

from __future__ import annotations

import copy
from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike

Array = NDArray[np.float64]

#: What a worn machine's MJCF calls the body on its back (`docs/your_machine.md`).
PAYLOAD = "payload"


class MovingMasses:
    """Gathers, sample by sample, the generalised forces of inertia, gravity and centrifugal forces.

    Accelerations come smoothed, and what depends on the pose is smoothed beside them. Of a mass that changes meanwhile the filter of the
    forces takes `G(M a)`, which differs from `M G(a)` by what the restored motion shows of it.

    Args:
        model: Of the machine, its constraints off.
        time: Of the samples, shape (n,) [s].
        motion: Restored positions (n, nq) and velocities (n, nv), and smoothed accelerations (n, nv).
        smoothing: Width of the filter that noise asks for [s].
    """

    def __init__(self, model: mujoco.MjModel, time: Array, motion: tuple[Array, Array, Array], smoothing: float = 0.0) -> None:
        self._model, self._time, self._motion, self._smoothing = model, time, motion, smoothing
        self.data = mujoco.MjData(model)
        n = len(time)
        self._inverse, self._bias, self._quick, self._slow = np.zeros((4, n, model.nv))
        self._passive = np.zeros((n, model.nv))
        data = self.data  # MuJoCo's arrays: to ask for each of them at every sample takes as long as the dynamics
        self._state = data.qpos, data.qvel, data.qacc
        self._asked = data.qfrc_inverse, data.qfrc_passive, data.qfrc_bias
        self._rubs = bool(model.dof_frictionloss.any() or model.tendon_frictionloss.any())
        self._dry = np.zeros((n if self._rubs else 0, model.nv))
        self._varies = model.nv > 1
        if self._varies:
            self._quicker = np.gradient(motion[1], time, axis=0)
            self._slower = self._filtered(self._quicker)

    def _filtered(self, values: Array) -> Array:
        return np.apply_along_axis(partial(smoothed_alike, self._time, asked=self._smoothing), 0, values)

    def move(self, i: int) -> mujoco.MjData:
        """Take sample `i`, and return what MuJoCo knows of it."""
        data, (q, qd, qdd), (inverse, passive, bias) = self.data, self._state, self._asked
        q[:], qd[:], qdd[:] = self._motion[0][i], self._motion[1][i], self._motion[2][i]
        mujoco.mj_inverse(self._model, data)
        self._inverse[i], self._passive[i], self._bias[i] = inverse, passive, bias
        if self._rubs:
            self._dry[i] = _dry(self._model, data)
        if self._varies:
            mujoco.mj_mulM(self._model, data, self._quick[i], self._quicker[i])
            mujoco.mj_mulM(self._model, data, self._slow[i], self._slower[i])
        return data

    @property
    def passive(self) -> Array:
        """Generalised forces of springs, damping and dry friction, shape (n, nv)."""
        return self._passive + (self._dry if self._rubs else 0.0)

    def gathered(self) -> tuple[Array, Array]:
        """Return all of it, and the part that does not go with acceleration, behind the filter of the balance, shape (n, nv) each."""
        bias = self._filtered(self._bias)
        found = self._inverse + self._passive + (bias - self._bias)
        return (found + (self._filtered(self._quick) - self._slow) if self._varies else found), bias


def _dry(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Return what the MJCF's `frictionloss` of joints and tendons does while they slide, shape (nv,): to MuJoCo it is a constraint."""
    found = -model.dof_frictionloss * np.sign(data.qvel)
    if model.ntendon and model.tendon_frictionloss.any():
        lead = np.zeros((model.ntendon, model.nv))
        mujoco.mju_sparse2dense(lead, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind)
        found = found - (model.tendon_frictionloss * np.sign(data.ten_velocity)) @ lead
    return np.asarray(found)


def payload(model: mujoco.MjModel) -> int | None:
    """Return the body on the back of a machine, if it has one with mass."""
    body = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, PAYLOAD))
    return body if body >= 0 and model.body_mass[body] > 1e-3 * float(model.body_subtreemass[0]) else None


def with_twice_the_payload(model: mujoco.MjModel, body: int) -> mujoco.MjModel:
    """Return a copy of a machine that carries twice as much of the same."""
    heavier = copy.copy(model)
    heavier.body_mass[body] *= 2.0
    heavier.body_inertia[body] *= 2.0
    mujoco.mj_setConst(heavier, mujoco.MjData(heavier))
    return heavier
