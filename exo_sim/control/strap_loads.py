"""What loads the wearer along a motion: the moments of the own body, and what a unit force of each strap adds to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import PICK, MachineDynamics
from exo_sim.gait.motion import Motion
from exo_sim.gait.moving_body import Moving, body_loads
from exo_sim.machine.ground_reaction import hold, joint_moments, linear_ground, totals
from exo_sim.machine.person import Person
from exo_sim.machine.straps import StrapSet


def force_sums(dynamics: MachineDynamics, straps: StrapSet) -> NDArray[np.float64]:
    """Return the force of all torso straps, ahead and up, and of all straps ahead, for a unit force of each, shape (n, 3, 2 straps)."""
    n = len(dynamics.strap)
    out = np.zeros((n, 3, 2 * len(straps.names)))
    for i, name in enumerate(straps.names):
        direction = dynamics.strap_direction[:, i].transpose(0, 2, 1)
        if name.startswith("torso"):
            out[:, :2, 2 * i : 2 * i + 2] = direction
        out[:, 2, 2 * i : 2 * i + 2] = direction[:, 0]
    return out


def own_moments(motion: Motion, person: Person) -> NDArray[np.float64]:
    """Return the moments of the wearer's own body along the motion [N m], shape (n, 6)."""
    poses, wrench = body_loads(Moving.of(motion, PICK), person)
    ground = hold(poses, wrench, motion.share[PICK], motion.pressure_centre[PICK], motion.support[PICK], person, motion.ground.angle)
    return joint_moments(poses, wrench, ground.force, ground.place)


@dataclass(frozen=True)
class StrapLoads:
    """What a unit force of each strap on the machine does to the wearer, n phases, straps across and along.

    Attributes:
        moments: Extra moments of his joints where centres of pressure move as they are asked to, shape (n, 6, 2 straps).
        moved: What moving the centres adds to the moment about the pelvis from left and right foot, shape (n, 2, 2 straps).
        sums: `force_sums`.
    """

    moments: NDArray[np.float64]
    moved: NDArray[np.float64]
    sums: NDArray[np.float64]

    @classmethod
    def of(cls, dynamics: MachineDynamics, motion: Motion, person: Person, straps: StrapSet) -> StrapLoads:
        """Return what straps do along a motion."""
        n, n_straps = dynamics.strap.shape[:2]
        moments, moved = np.empty((n, 6, 2 * n_straps)), np.empty((n, 2, 2 * n_straps))
        for i in range(n_straps):
            segment = straps.segment[i]
            # directions are rows across, along; the anchor in space is across * x + along * z
            direction = dynamics.strap_direction[:, i]
            arm = straps.anchor[i, 0] * direction[:, 0] + straps.anchor[i, 1] * direction[:, 1]
            for k in range(2):
                force = -direction[:, k]
                wrench = np.zeros((n, 7, 3))
                wrench[:, segment, :2] = force
                wrench[:, segment, 2] = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
                on_feet, place, moved[:, :, 2 * i + k] = linear_ground(
                    dynamics.poses, totals(dynamics.poses, wrench), motion.share[PICK], motion.pressure_centre[PICK], person.ankle_height
                )
                moments[:, :, 2 * i + k] = joint_moments(dynamics.poses, wrench, on_feet, place, moved[:, :, 2 * i + k])
        return cls(moments, moved, force_sums(dynamics, straps))

    def at(self, at_edge: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return all loads of a unit force of each strap: six joint moments, the residual moment, and sums of forces.

        Args:
            at_edge: For what share of each phase the centres of pressure are where soles end, so that they move no farther: what they
                would have added no joint feels, it is left over. Shape (n,).

        Returns:
            Shape (n, 10, 2 straps).
        """
        kept = at_edge[:, None, None] * self.moved
        joints = self.moments + np.repeat(kept, 3, axis=1)
        return np.concatenate([joints, kept.sum(axis=1, keepdims=True), self.sums], axis=1)
