"""Which angles of hip, knee and ankle bring a foot to a place: the inverse of `person.leg_points`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.person import Person

Array = NDArray[np.float64]

#: A leg is at least so much shorter than thigh and shank [m].
_BENT = 5e-4


def turned(angle: Array, ahead: Array | float, up: float) -> Array:
    """Return a vector of a segment, along and across it [m], in space where the segment is at an angle [rad]: x and z, shape (n, 2)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([ahead * cosine - up * sine, ahead * sine + up * cosine], axis=-1)


def leg_to(ankle: Array, tilt: Array, pitch: Array, person: Person) -> Array:
    """Return hip, knee and ankle angles that bring an ankle to a place; a leg that cannot reach it points there, stretched.

    Args:
        ankle: From the hip, x and z [m], shape (n, 2).
        tilt: Of the foot in space [rad], shape (n,).
        pitch: Of the torso [rad], shape (n,).
        person: Whose leg.

    Returns:
        Shape (n, 3).
    """
    far = np.minimum(np.hypot(ankle[:, 0], ankle[:, 1]), person.thigh + person.shank - _BENT)
    bend = (far**2 - person.thigh**2 - person.shank**2) / (2.0 * person.thigh * person.shank)
    knee = -np.arccos(np.clip(bend, -1.0, 1.0))
    thigh = np.arctan2(ankle[:, 0], -ankle[:, 1])
    thigh -= np.arctan2(person.shank * np.sin(knee), person.thigh + person.shank * np.cos(knee))
    return np.stack([thigh - pitch, knee, tilt - thigh - knee], axis=1)
