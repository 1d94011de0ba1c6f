"""A walk as the paths of pelvis and feet over the ground, and back: so that it can go on over other ground, in longer or shorter strides.

In stance a foot rolls over heel and ball, which stay where they are. Between both it bears on a point that moves from the one to the
other; this point's place along the ground and height above it, and the pitch of the foot to the ground, are what stays the same where the
ground changes. Hip, knee and ankle follow from where pelvis and feet are (`machine/leg_angles.py`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.motion import SAMPLES, Motion, phases, smooth, travelling
from exo_sim.machine.ground import Ground
from exo_sim.machine.ground_reaction import FEET
from exo_sim.machine.leg_angles import leg_to, turned
from exo_sim.machine.person import LEG_START, Person, poses_along

Array = NDArray[np.float64]

#: Phases from a foot's own heel strike over which it rolls from heel to ball, and back in the air.
_ROLLS, _ROLLS_BACK = (0.13, 0.36), (0.66, 0.94)
#: So long before and after a leg would be stretched too far the pelvis is lower, in strides.
_BOW = 0.12


@dataclass(frozen=True)
class Paths:
    """Where pelvis and feet are along one cycle of n samples, left foot first.

    Attributes:
        pelvis: Ahead, the steady advance included, and above the ground at the origin [m], shape (n, 2).
        trunk: Its pitch [rad], shape (n,).
        ahead: Where along the ground each foot's ankle would be were the foot flat [m], shape (n, 2).
        up: Of the point that bears, above the ground [m], shape (n, 2).
        pitch: Of each foot to the ground, toes up positive [rad], shape (n, 2).
        roll: Where the foot bears, from 0, the heel, to 1, the ball, shape (n, 2).
    """

    pelvis: Array
    trunk: Array
    ahead: Array
    up: Array
    pitch: Array
    roll: Array


def rolling(phase: Array) -> Array:
    """Return where a foot bears at phases from its own heel strike, 0 (heel) to 1 (ball), the shape of `phase`."""
    forward = smooth((phase - _ROLLS[0]) / (_ROLLS[1] - _ROLLS[0]))
    back = smooth((phase - _ROLLS_BACK[0]) / (_ROLLS_BACK[1] - _ROLLS_BACK[0]))
    return np.asarray(forward - back)


def paths(motion: Motion, person: Person) -> Paths:
    """Return the paths of a walk on level ground, one stride."""
    right = phases()
    roll = np.stack([rolling((right + 0.5) % 1.0), rolling(right)], axis=1)
    poses = poses_along(motion.position, np.zeros_like(motion.position), person)
    steady = motion.advance * right
    pitch = poses[:, FEET, 2]
    bears = person.heel + roll * (person.toe - person.heel)
    point = poses[:, FEET, :2] + np.stack([turned(pitch[:, i], bears[:, i], -person.ankle_height) for i in range(2)], axis=1)
    pelvis = motion.position[:, :2].copy()
    pelvis[:, 0] += steady
    return Paths(pelvis, motion.position[:, 2].copy(), point[:, :, 0] + steady[:, None] - bears, point[:, :, 1], pitch, roll)


def walked(it: Paths, like: Motion, person: Person, ground: Ground, advance: float, period: float) -> Motion:
    """Return paths as a motion over some ground.

    Args:
        it: Of one cycle.
        like: Says what else there is of a motion: shares, centres of pressure, contacts.
        person: Who walks.
        ground: Where; paths along a slope are along its surface, those on stairs have their treads in `up`.
        advance: How far ahead a cycle goes [m].
        period: How long it takes [s].
    """
    n = len(it.pelvis)
    steady = np.arange(n) / n
    position = np.zeros((n, 9))
    position[:, 0] = it.pelvis[:, 0] - advance * steady
    position[:, 1] = it.pelvis[:, 1] - ground.grade * advance * steady
    position[:, 2] = it.trunk
    ankles, tilt = ankle_paths(it, person, ground)
    for i, first in enumerate(LEG_START.values()):
        position[:, first : first + 3] = leg_to(ankles[:, i] - it.pelvis, tilt[:, i], it.trunk, person)
    return travelling(replace(like, advance=advance, period=period, ground=ground), position)


def with_pelvis_ahead(motion: Motion, person: Person, ahead: Array) -> Motion:
    """Return a motion with the pelvis so far ahead [m], shape (n,), of a walk from rest to rest.

    Feet and trunk stay where they are, legs follow; where they do not reach, the pelvis is lower for a while.
    """
    poses = poses_along(motion.position, np.zeros_like(motion.position), person)
    ankles = poses[:, FEET, :2]
    far = float(np.hypot(*np.moveaxis(ankles - motion.position[:, None, :2], -1, 0)).max())
    position = motion.position.copy()
    position[:, 0] += ahead
    position[:, 1] -= _lower(ankles, position[:, :2], far)
    for row, first in zip(FEET, LEG_START.values()):
        position[:, first : first + 3] = leg_to(poses[:, row, :2] - position[:, :2], poses[:, row, 2], position[:, 2], person)
    return travelling(motion, position)


def ankle_paths(it: Paths, person: Person, ground: Ground) -> tuple[Array, Array]:
    """Return where the ankles are [m], shape (n, 2, 2), and the feet's angle in space [rad], shape (n, 2)."""
    slope = ground.angle
    bears = person.heel + it.roll * (person.toe - person.heel)
    along = it.ahead + bears
    point = np.stack([along * np.cos(slope) - it.up * np.sin(slope), along * np.sin(slope) + it.up * np.cos(slope)], axis=-1)
    tilt = it.pitch + slope
    return point - np.stack([turned(tilt[:, i], bears[:, i], -person.ankle_height) for i in range(2)], axis=1), tilt


def reach(it: Paths, person: Person, ground: Ground) -> float:
    """Return how far the hips are from an ankle at the most [m]."""
    ankles, _ = ankle_paths(it, person, ground)
    return float(np.hypot(*np.moveaxis(ankles - it.pelvis[:, None], -1, 0)).max())


def bowed(it: Paths, person: Person, ground: Ground, far: float) -> Paths:
    """Return paths of a walk from rest to rest with the pelvis lower for a while where legs would be stretched farther than said [m]."""
    ankles, _ = ankle_paths(it, person, ground)
    return replace(it, pelvis=it.pelvis - np.stack([np.zeros(len(ankles)), _lower(ankles, it.pelvis, far)], axis=1))


def _lower(ankles: Array, pelvis: Array, far: float) -> Array:
    """Return by how much a pelvis, shape (n, 2), is to be lower so that no ankle, shape (n, 2, 2), is farther than said [m], shape (n,)."""
    from scipy.ndimage import gaussian_filter1d, maximum_filter1d  # not for walks as they were recorded

    along = np.clip(np.abs(ankles[:, :, 0] - pelvis[:, :1]), 0.0, 0.999 * far)
    short = pelvis[:, 1] - (ankles[:, :, 1] + np.sqrt(far**2 - along**2)).min(axis=1)
    wide = round(_BOW * SAMPLES)
    longest = maximum_filter1d(np.maximum(short, 0.0), 2 * wide + 1, mode="wrap")
    return np.asarray(gaussian_filter1d(longest, 0.5 * wide, mode="wrap"))


def within_reach(it: Paths, person: Person, ground: Ground, far: float, bob: float) -> Paths:
    """Return paths with the pelvis as high as legs allow that are stretched as far as said, and no farther.

    Args:
        it: Of one stride.
        person: Who walks.
        ground: Where.
        far: From hip to ankle at the most [m].
        bob: By how much the pelvis may rise and fall more than it does, once a step, and a quarter of it twice a step [m].
    """
    from scipy.optimize import linprog  # not for walks as they were recorded

    ankles, _ = ankle_paths(it, person, ground)
    along = np.clip(np.abs(ankles[:, :, 0] - it.pelvis[:, :1]), 0.0, 0.999 * far)
    room = (ankles[:, :, 1] + np.sqrt(far**2 - along**2)).min(axis=1) - it.pelvis[:, 1]
    step = 4.0 * np.pi * np.arange(len(room)) / len(room)
    waves = np.stack([np.ones(len(room)), *(wave(h * step) for h in (1, 2) for wave in (np.cos, np.sin))], axis=1)
    most = np.array([1.0, bob, bob, 0.25 * bob, 0.25 * bob])  # as jerky
    found = linprog([-1.0, 0.0, 0.0, 0.0, 0.0], waves, room, bounds=list(zip(-most, most)))
    return replace(it, pelvis=it.pelvis + np.stack([np.zeros(len(room)), waves @ found.x], axis=1))
