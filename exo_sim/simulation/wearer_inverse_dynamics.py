"""A body held along some rows: what its joints, soles and pelvis must give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine import ground_reaction
from exo_sim.machine.ground_reaction import Ground
from exo_sim.machine.person import Person

_JOINTS = ("hip", "knee", "ankle")
#: A foot that carries less may slide [N].
SLIDES_UNDER = 50.0


@dataclass(frozen=True)
class Held:
    """A body held along some rows.

    Attributes:
        poses: Of the segments, shape (n, 7, 6).
        wrench: All loads on them, own weight and inertia among them, shape (n, 7, 3).
        ground: What soles, seat and residual give.
        moments: hip, knee, ankle of the left, then of the right leg [N m], shape (n, 6).
        rates: Of the same joints [rad/s], shape (n, 6).
    """

    poses: NDArray[np.float64]
    wrench: NDArray[np.float64]
    ground: Ground
    moments: NDArray[np.float64]
    rates: NDArray[np.float64]

    @property
    def powers(self) -> NDArray[np.float64]:
        """What the joints give [W], shape (n, 6)."""
        return self.moments * self.rates

    @property
    def sole_powers(self) -> NDArray[np.float64]:
        """What the foot below each ankle gives as it yields between the rigid sole and the ground [W], shape (n, 2)."""
        return np.asarray((self.ground.force * self.sole_speeds).sum(axis=2))

    @property
    def sole_speeds(self) -> NDArray[np.float64]:
        """Velocity of the sole of each foot at its centre of pressure, along the ground and up [m/s], shape (n, 2, 2)."""
        feet = self.poses[:, ground_reaction.FEET]
        arm = self.ground.place - (feet[:, :, :2] - self.poses[:, :1, :2])
        return np.stack([feet[:, :, 3] - arm[:, :, 1] * feet[:, :, 5], feet[:, :, 4] + arm[:, :, 0] * feet[:, :, 5]], axis=-1)

    def slid(self, period: float) -> NDArray[np.float64]:
        """Return how far the sole of each foot slides along the ground under its centre of pressure while it carries [m], shape (2,).

        Args:
            period: Of the cycle [s], whose rows, evenly spaced, these are.
        """
        carries = self.ground.force[:, :, 1] > SLIDES_UNDER
        steps = np.where(carries, self.sole_speeds[:, :, 0], 0.0) * (period / len(carries))
        landing = np.argmax(carries & ~np.roll(carries, 1, axis=0), axis=0)
        way = np.stack([np.cumsum(np.roll(one, -first)) for one, first in zip(steps.T, landing)])
        return np.asarray(np.ptp(way, axis=1))

    def by_joint(self) -> dict[str, NDArray[np.float64]]:
        """Return the powers of left and right hips, knees, ankles and feet [W], shape (n, 2) each."""
        return {**{name: self.powers[:, k::3] for k, name in enumerate(_JOINTS)}, "foot": self.sole_powers}


def held(
    poses: NDArray[np.float64],
    wrench: NDArray[np.float64],
    share: NDArray[np.float64],
    centre: NDArray[np.float64],
    support: NDArray[np.float64],
    person: Person,
    slope: float = 0.0,
) -> Held:
    """Hold a body; arguments are those of `ground_reaction.hold`."""
    ground = ground_reaction.hold(poses, wrench, share, centre, support, person, slope)
    moments = ground_reaction.joint_moments(poses, wrench, ground.force, ground.place)
    turning = poses[:, :, 5]
    rates = np.stack([turning[:, i] - turning[:, 0 if i in (1, 4) else i - 1] for i in range(1, 7)], axis=1)
    return Held(poses, wrench, ground, moments, rates)
