"""Where all that a balance of forces is made of was recorded: a filter bridges a hole by a straight line, which is no force.

What lies beside a hole by less than the filter reaches has some of that line in it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.subsystems.motion.smoothing import reach, stride, thinned
from exo_sim.machine.linkage import Linkage
from exo_sim.recording.table import Recording
from exo_sim.recording.windows import holes
from exo_sim.rig import Rig

Array = NDArray[np.float64]

def columns_of_balance(recording: Recording, rig: Rig, joints: Sequence[str], joint: str, driven: Sequence[Linkage]) -> list[str]:
    """Return the recorded columns that a joint's balance is made of: every joint's position, what drives it and what pushes it.

    Args:
        recording, rig: The machine's.
        joints: All joints: the motion of one asks forces of another.
        joint: That of the balance.
        driven: The cylinders that drive it.
    """
    columns = [f"{name}.position" for name in joints] + [f"{joint}.external_force"]
    for link in driven:
        sides = (1,) if rig.cylinders[link.cylinder].single_acting else (1, 2)
        cell = f"{link.cylinder}.force"
        columns += [cell] if cell in recording else [f"{link.cylinder}.pressure_{side}" for side in sides]
    return [column for column in columns if column in recording]


def recorded(time: Array, channels: Sequence[Array | None], asked: float = 0.0) -> NDArray[np.bool_]:
    """Return at which samples that a balance keeps no channel has a hole within the filter's reach, shape (kept,).

    Args:
        time: Clock of the recording, shape (n,) [s].
        channels: What the balance is made of, shape (n,) each.
        asked: As of `smoothing_width` [s].
    """
    there, beside = np.ones(len(time), dtype=bool), reach(time, asked)
    for values in channels:
        for begin, end in [] if values is None else holes(time, values):
            there[max(0, begin - beside) : end + beside] = False
    return np.asarray(thinned(there, stride(time)))
