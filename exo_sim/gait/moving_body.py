"""Samples of a motion by time, and what moving and holding the wearer's own body along them asks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import Motion
from exo_sim.machine import anthropometry
from exo_sim.machine.person import Person, poses_along


class Moving(NamedTuple):
    """Samples of motions: `person.COORDINATES`, their rates and accelerations by time, shape (n, 9) each."""

    position: NDArray[np.float64]
    rate: NDArray[np.float64]
    acceleration: NDArray[np.float64]

    @classmethod
    def of(cls, motion: Motion, rows: slice = slice(None)) -> Moving:
        """Return some samples of a cycle."""
        rate = 1.0 / motion.period
        return cls(motion.position[rows], motion.slope[rows] * rate, motion.curvature[rows] * rate**2)


def trunk(along: Moving) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return pelvis and trunk with their rates, shape (n, 6), and their accelerations, (n, 3), for `wearer_moments.backpack_wrench`."""
    return np.concatenate([along.position[:, :3], along.rate[:, :3]], axis=1), along.acceleration[:, :3]


def body_loads(along: Moving, person: Person) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the segments' poses, shape (n, 7, 6), and their weight and inertia, shape (n, 7, 3)."""
    poses = poses_along(along.position, along.rate, person)
    return poses, anthropometry.body_wrench(poses, anthropometry.accelerations(along.acceleration, poses, person), person)
