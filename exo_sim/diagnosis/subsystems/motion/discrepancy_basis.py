"""What every model of friction gets wrong: it depends a little on place, on speed beyond its law, and on how long the machine has run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis, joined, smooth_functions
from exo_sim.diagnosis.policy import healthy

Array = NDArray[np.float64]

#: Knots of the functions of place, of the logarithm of speed, and of time in each recording.
PLACE, SPEED, TIME = 8, 7, 4


def friction_discrepancy(
    position: Array, velocity: Array, time: Array, recording: NDArray[np.int64], weight: Array, friction: float, effort: float
) -> DiscrepancyBasis:
    """Return the discrepancy of a balance of forces.

    Args:
        position, velocity, time: At the rows, shape (n,).
        recording: Which recording each row is from, shape (n,).
        weight: By how much more precise each row is than a typical one, shape (n,).
        friction: Size of all friction that acts, in units of the noise of a typical row.
        effort: Size of the forces that act, the same.
    """
    direction = np.sign(velocity)
    place = []
    for way in (direction > 0.0, direction < 0.0):
        if np.count_nonzero(way) > healthy.FEWEST_FOR_FUNCTIONS:
            found = smooth_functions(position[way], PLACE)
            columns = np.zeros((len(position), found.shape[1]))
            columns[way] = found
            place.append(columns)
    speed = smooth_functions(np.log(np.maximum(np.abs(velocity), 1e-12)), SPEED) * direction[:, None]
    late = []
    for index in np.unique(recording):
        own = recording == index
        if np.count_nonzero(own) > healthy.FEWEST_FOR_FUNCTIONS:
            found = smooth_functions(time[own], TIME)
            columns = np.zeros((len(time), found.shape[1]))
            columns[own] = found
            late.append(columns * direction[:, None])
    kinds = (
        ("position", place, healthy.FRICTION_PLACE), ("velocity", [speed], healthy.FRICTION_SPEED), ("time", late, healthy.FRICTION_TIME)
    )  # fmt: skip
    floor = healthy.FORCE_UNEXPLAINED * effort
    return joined([(n, np.hstack(c) * weight[:, None], share * friction + floor) for n, c, share in kinds if c], len(position))
