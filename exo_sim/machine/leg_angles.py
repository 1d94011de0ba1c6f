"""Which angles of hip, knee and ankle bring a foot to a place: the inverse of `person.leg_points`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.person import Person

Array = NDArray[np.float64]

#: A leg is at least so much shorter than thigh and shank, and from so much on as short as it is asked to be [m]: knees of 4 and 8 degrees.
#: Straight, a knee turns infinitely fast as the ankle moves, and one that overextends and comes back would turn over.
_BENT, _FREE = 5e-4, 2e-3
#: Damping of `held_back` [m^2]: a stretched leg is not bent for a foot that stays.
_DAMPING = 0.004


def turned(angle: Array, ahead: Array | float, up: float) -> Array:
    """Return a vector of a segment, along and across it [m], in space where the segment is at an angle [rad]: x and z, shape (n, 2)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([ahead * cosine - up * sine, ahead * sine + up * cosine], axis=-1)


def leg_to(ankle: Array, tilt: Array, pitch: Array, person: Person) -> Array:
    """Return hip, knee and ankle angles that bring an ankle to a place; a leg that cannot reach it points there, nearly stretched.

    Args:
        ankle: From the hip, x and z [m], shape (n, 2).
        tilt: Of the foot in space [rad], shape (n,).
        pitch: Of the torso [rad], shape (n,).
        person: Whose leg.

    Returns:
        Shape (n, 3).
    """
    whole = person.thigh + person.shank
    far = whole - _shorter(whole - np.hypot(ankle[:, 0], ankle[:, 1]))
    bend = (far**2 - person.thigh**2 - person.shank**2) / (2.0 * person.thigh * person.shank)
    knee = -np.arccos(np.clip(bend, -1.0, 1.0))
    thigh = np.arctan2(ankle[:, 0], -ankle[:, 1])
    thigh -= np.arctan2(person.shank * np.sin(knee), person.thigh + person.shank * np.cos(knee))
    return np.stack([thigh - pitch, knee, tilt - thigh - knee], axis=1)


def held_back(ahead: Array, thigh: Array, knee: Array, person: Person) -> Array:
    """Return by how much hip, knee and ankle turn so that a foot stays where it is, as flat as it is, while the hip goes ahead.

    To first order, by damped least squares: of a stretched leg the foot rises or sinks a little.

    Args:
        ahead: By how much the hip goes ahead [m], shape (n,).
        thigh: Angle of the thigh in space before that [rad], shape (n,).
        knee: Of the knee [rad], shape (n,).
        person: Whose leg.

    Returns:
        [rad], shape (3, n).
    """
    below = turned(thigh + knee, 0.0, -person.shank)
    whole = below + turned(thigh, 0.0, -person.thigh)
    # turning a joint moves the ankle across its lever
    (knee_x, knee_z), (hip_x, hip_z) = (-below[:, 1], below[:, 0]), (-whole[:, 1], whole[:, 0])
    xx, xz, zz = hip_x**2 + knee_x**2 + _DAMPING, hip_x * hip_z + knee_x * knee_z, hip_z**2 + knee_z**2 + _DAMPING
    scale = -ahead / (xx * zz - xz * xz)
    by_hip, by_knee = scale * (zz * hip_x - xz * hip_z), scale * (zz * knee_x - xz * knee_z)
    return np.stack([by_hip, by_knee, -by_hip - by_knee])


def _shorter(gap: Array) -> Array:
    """Return by how much a leg is shorter than thigh and shank, of how much it is asked to be: `_BENT` at least, all without a jerk.

    Between the two numbers it is the polynomial that meets the straight line beyond with slope and curvature, and ends level at 0.
    """
    u, least = np.clip(gap / _FREE, 0.0, 1.0), _BENT / _FREE
    eased = least + u**2 * ((3.0 - 6.0 * least) - u * ((3.0 - 8.0 * least) - u * (1.0 - 3.0 * least)))
    return np.where(gap >= _FREE, gap, _FREE * eased)
