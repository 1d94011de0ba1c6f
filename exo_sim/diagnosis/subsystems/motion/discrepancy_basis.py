"""What every model of friction gets wrong.

It depends a little on place, on speed beyond its law, the same or not the same in both directions, and on how long the machine has run.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis, joined, smooth_functions
from exo_sim.diagnosis.policy import healthy

Array = NDArray[np.float64]

#: Knots of the functions of place in each direction, of the logarithm of speed, and of time in each recording.
PLACE, SPEED, TIME = 8, 7, 4


def friction_discrepancy(
    position: Array, velocity: Array, time: Array, recording: NDArray[np.int64], weight: Array, friction: float, effort: float,
    of_motion: int | None = None,
) -> DiscrepancyBasis:  # fmt: skip
    """Return the discrepancy of a balance of forces.

    Args:
        position, velocity, time: At the rows, shape (n,).
        recording: Which recording each row is from, shape (n,).
        weight: By how much more precise each row is than a typical one, shape (n,).
        friction: Size of all friction that acts, in units of the noise of a typical row.
        effort: Size of the forces that act, the same.
        of_motion: How many rows are of the motion, the first ones, all where None: the others are onsets, which are no rows before they
            exceed what a law of speed gets wrong (`breakaway`).
    """
    direction = np.sign(velocity)
    ways = [direction > 0.0, direction < 0.0]
    each = [recording == index for index in np.unique(recording)]
    place = _functions(position, PLACE, ways)
    of_motion = len(velocity) if of_motion is None else of_motion
    sliding = smooth_functions(np.log(np.maximum(np.abs(velocity[:of_motion]), 1e-12)), SPEED)
    speed = np.vstack([sliding, np.zeros((len(velocity) - of_motion, sliding.shape[1]))])
    apart = speed if all(np.count_nonzero(way) > healthy.FEWEST_FOR_FUNCTIONS for way in ways) else speed[:, :0]
    late = [columns * direction[:, None] for columns in _functions(time, TIME, each)]
    kinds = (
        ("position", place, healthy.FRICTION_PLACE),
        ("velocity", [speed * direction[:, None]], healthy.FRICTION_SPEED),
        ("direction", [apart], healthy.FRICTION_DIRECTION),  # by speed: more at a speed one way, less the other
        ("time", late, healthy.FRICTION_TIME),
    )
    floor = healthy.FORCE_UNEXPLAINED * effort
    return joined([(n, np.hstack(c) * weight[:, None], share * friction + floor) for n, c, share in kinds if c], len(position))


def _functions(variable: Array, knots: int, parts: Sequence[NDArray[np.bool_]]) -> list[Array]:
    """Return smooth functions of a variable, shape (n, knots), for each part of the rows that is large enough for functions of its own."""
    found = []
    for part in parts:
        if np.count_nonzero(part) > healthy.FEWEST_FOR_FUNCTIONS:
            own = smooth_functions(variable[part], knots)
            columns = np.zeros((len(variable), own.shape[1]))
            columns[part] = own
            found.append(columns)
    return found
