"""Making a machine that nobody wears follow a motion: computed torque, shared among the cylinders.

The force of each driven coordinate is that of inverse dynamics for the acceleration wanted, corrected by the error of position and velocity
and by its integral (computed torque; Siciliano et al. 2009, "Robotics", section 8.5). Rod forces are the least, relative to what each
cylinder can hold, that make it.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TrackingGains:
    """Of the joints' control.

    Attributes:
        pace: Natural frequency at which an error closes, critically damped [rad/s].
        integral: The same for the integral of the error, as a share of `pace` cubed.
    """

    pace: float = 25.0
    integral: float = 0.15


class Tracking:
    """Joint forces and rod forces that follow a motion.

    Args:
        model: Of the machine.
        dofs: Degrees of freedom that are driven, shape (m,).
        actuators: Of the cylinders, shape (n,).
        limits: Least and largest force of each rod [N], shape (n, 2).
        gains: Of the control.
    """

    def __init__(
        self, model: mujoco.MjModel, dofs: NDArray[np.int64], actuators: NDArray[np.int64], limits: Array, gains: TrackingGains
    ) -> None:
        self._model, self._dofs, self._actuators, self._limits, self._gains = model, dofs, actuators, limits, gains
        self._scratch = mujoco.MjData(model)
        self._sum = np.zeros(len(dofs))
        self._capacity = np.abs(limits).max(axis=1)
        self._saturated = False

    def reset(self) -> None:
        """Forget the integral of the error."""
        self._sum[:] = 0.0
        self._saturated = False

    def joint_force(self, data: mujoco.MjData, position: Array, velocity: Array, acceleration: Array, dt: float) -> Array:
        """Return the generalised force of the driven coordinates [N m, N], shape (m,).

        Args:
            data: After `mj_step1`, outside forces in `qfrc_applied`.
            position, velocity, acceleration: Wanted of the driven coordinates, shape (m,).
            dt: Time since the last call [s].
        """
        pace, dofs, model = self._gains.pace, self._dofs, self._model
        joints = model.dof_jntid[dofs]
        off = position - data.qpos[model.jnt_qposadr[joints]]
        if not self._saturated:
            self._sum += off * dt
        wanted = acceleration + 2.0 * pace * (velocity - data.qvel[dofs]) + pace**2 * off + self._gains.integral * pace**3 * self._sum
        inverse = self._scratch
        inverse.qpos[:], inverse.qvel[:] = data.qpos, data.qvel
        inverse.qacc[:] = 0.0
        inverse.qacc[dofs] = wanted
        flags = model.opt.disableflags
        model.opt.disableflags = flags | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)  # end stops are not to be pushed through
        try:
            mujoco.mj_inverse(model, inverse)
        finally:
            model.opt.disableflags = flags
        return np.asarray(inverse.qfrc_inverse[dofs] - data.qfrc_applied[dofs])

    def rod_forces(self, data: mujoco.MjData, force: Array) -> Array:
        """Return the rod forces that make a generalised force, within what the cylinders can hold [N], shape (n,)."""
        arms = np.zeros((len(self._actuators), self._model.nv))
        for i, actuator in enumerate(self._actuators):
            start, count = data.moment_rowadr[actuator], data.moment_rownnz[actuator]
            arms[i, data.moment_colind[start : start + count]] = data.actuator_moment[start : start + count]
        weighted = (arms[:, self._dofs] * self._capacity[:, None]).T
        share, *_ = np.linalg.lstsq(weighted, force, rcond=1e-6)
        wanted = share * self._capacity
        held = np.clip(wanted, self._limits[:, 0], self._limits[:, 1])
        self._saturated = bool(np.abs(held - wanted).max(initial=0.0) > 1e-9)
        return np.asarray(held)

    def made(self, data: mujoco.MjData, rods: Array) -> Array:
        """Return the generalised force that rod forces make on all coordinates, shape (nv,)."""
        out = np.zeros(self._model.nv)
        for i, actuator in enumerate(self._actuators):
            start, count = data.moment_rowadr[actuator], data.moment_rownnz[actuator]
            out[data.moment_colind[start : start + count]] += data.actuator_moment[start : start + count] * rods[i]
        return out
