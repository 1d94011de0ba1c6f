"""What a rehearsal showed, means over its cycles at the n even phases of `machine_dynamics.PICK`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.walk_response import WalkResponse


@dataclass(frozen=True)
class Rehearsed:
    """One rehearsal.

    Attributes:
        moments: The wearer's extra moments [N m], shape (n, 6).
        straps: Force of all torso straps, ahead and up, and of all straps ahead [N], shape (n, 3).
        contacts: For what share of each phase each of `machine_dynamics.CONTACTS` carried, shape (n, 4).
        residual: Moment that no sole could give [N m], shape (n,).
        at_edge: For what share of each phase there was one, shape (n,).
        response: Works out how the machine answered along it; None where that cannot be had.
        pressed: Torque of each joint that chambers hold with pressure beyond what they should see [N m], shape (n, 6); None where no
            cylinder has such a limit.
        presses: By how much that grows with the joint's torque, shape (n, 6).
    """

    moments: NDArray[np.float64]
    straps: NDArray[np.float64]
    contacts: NDArray[np.float64]
    residual: NDArray[np.float64]
    at_edge: NDArray[np.float64]
    response: Callable[[], WalkResponse] | None = None
    pressed: NDArray[np.float64] | None = None
    presses: NDArray[np.float64] | None = None
