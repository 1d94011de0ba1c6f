"""What chambers of a walk hold with more pressure than they should see, as torques of the joints, and how that answers to the torques.

A chamber that is shut in is pressed together by its piston, and what the joint asks of it decides how far. Its valve moves both chambers
against each other, so that of a change of the torque about half is each one's.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import PICK
from exo_sim.deciding_number import Number
from exo_sim.gait.motion import Motion
from exo_sim.machine.linkage import linkages, moment_row
from exo_sim.rig import Rig
from exo_sim.rig.limits import rating
from exo_sim.simulation.walk import Walk

Array = NDArray[np.float64]

PRESSED_FROM = Number(
    0.95, "of the rating", "pressure of a chamber from which on a demand pays for it: what it pays keeps the peak below the rating itself",
)  # fmt: skip
#: Share of a change of the force that each of two chambers behind one valve makes.
_EACH = 0.5


@dataclass(frozen=True)
class ChamberLimits:
    """Along a cycle, n phases of `machine_dynamics.PICK`, of the k cylinders that have a limit.

    Attributes:
        names: Of these.
        joint: Which of the six joints each drives, shape (k,).
        arm: Torque of the joint for a newton of the rod [m], shape (n, k).
        area: Of both chambers' pistons [m^2], shape (k, 2).
        most: What each chamber should see at the most [Pa], shape (k,).
    """

    names: tuple[str, ...]
    joint: NDArray[np.int64]
    arm: Array
    area: Array
    most: Array

    @classmethod
    def of(cls, rig: Rig, model: mujoco.MjModel, motion: Motion) -> ChamberLimits:
        """Return the limits of those cylinders that are rated for more than the supply gives them."""
        found = []
        for link in linkages(rig, model):
            allowed = rating(rig, rig.cylinders[link.cylinder])
            if allowed is not None and rig.supply.pressure < PRESSED_FROM * allowed[0] and link.dof >= 3:
                found.append((link, PRESSED_FROM * allowed[0]))
        places = motion.position[PICK]
        arm = np.zeros((len(places), len(found)))
        data = mujoco.MjData(model)
        for i, position in enumerate(places if found else ()):
            data.qpos[: len(position)] = position
            mujoco.mj_forward(model, data)
            arm[i] = [moment_row(model, data, link.actuator)[link.dof] for link, _ in found]
        cylinders = [rig.cylinders[link.cylinder] for link, _ in found]
        return cls(
            tuple(one.name for one in cylinders), np.array([link.dof - 3 for link, _ in found], dtype=np.int64), arm,
            np.array([[one.area_1, one.area_2] for one in cylinders]).reshape(-1, 2), np.array([most for _, most in found]),
        )  # fmt: skip

    def passed(self, walk: Walk) -> tuple[Array, Array]:
        """Return by how much pressure was beyond the limits [Pa], negative in the second chamber, and its sign, shape (rows, k, 2) each."""
        pressure = np.stack([[walk.columns[f"{name}.pressure_{side}"] for side in (1, 2)] for name in self.names]).transpose(2, 0, 1)
        beyond = np.maximum(pressure - self.most[:, None], 0.0) * np.array([1.0, -1.0])
        return beyond, np.sign(beyond)

    def torques(self, beyond: Array, where: Array) -> tuple[Array, Array]:
        """Return `Rehearsed.pressed` and `presses` for means of `passed` at the n phases, shape (n, k, 2)."""
        pressed, presses = np.zeros((len(self.arm), 6)), np.zeros((len(self.arm), 6))
        each = (beyond * self.area).sum(axis=2) * self.arm
        share = _EACH * np.abs(where).sum(axis=2)
        for i, joint in enumerate(self.joint):
            pressed[:, joint] += each[:, i]
            presses[:, joint] = np.maximum(presses[:, joint], share[:, i])
        return pressed, presses
