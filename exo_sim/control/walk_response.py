"""How a walking machine, and with it the straps, answer to a change of the joint torques."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class WalkResponse:
    """One cycle of a walk, n steps: the next state for each state (coordinates and rates) and torque, and strap forces for each state.

    Attributes:
        phase: Of each step [cycles], shape (n,).
        by_state: Shape (n, 18, 18).
        by_torque: Shape (n, 18, m), m driven joints.
        straps: Forces on the machine, across and along, shape (n, 2 straps, 18).
    """

    phase: Array
    by_state: Array
    by_torque: Array
    straps: Array

    def steady(self, basis: Array, phases: int) -> Array:
        """Return strap forces that follow from steady changes of the torques.

        Args:
            basis: Torque of any driven joint for a unit of each number, at each step, shape (n, k).
            phases: Even phases of the cycle over whose shares means are taken.

        Returns:
            For each number of each driven joint, one joint after the other, shape (phases, 2 straps, m k).
        """
        width = self.by_torque.shape[2] * basis.shape[1]
        first = np.concatenate([np.eye(18), np.zeros((18, width))], axis=1)
        for state, torque, row in zip(self.by_state, self.by_torque, basis):
            first = state @ first
            first[:, 18:] += (torque[:, :, None] * row).reshape(18, -1)
        begun = np.linalg.solve(np.eye(18) - first[:, :18], first[:, 18:])
        box = np.floor(self.phase * phases + 0.5).astype(int) % phases
        out = np.zeros((phases, self.straps.shape[1], width))
        for at, force, state, torque, row in zip(box, self.straps, self.by_state, self.by_torque, basis):
            out[at] += force @ begun
            begun = state @ begun
            begun += (torque[:, :, None] * row).reshape(18, -1)
        return out / np.bincount(box, minlength=phases)[:, None, None]
