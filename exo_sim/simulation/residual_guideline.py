"""Whether a gait can be one of a body with mass: what is left at the pelvis, for no ground gives it, held against the published guideline.

OpenSim's guideline for walking: residuals of at most 25 N and 75 N m are acceptable (OpenSim documentation, "Simulation with OpenSim - Best
Practices").
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

#: At most [N], [N m].
FORCE, MOMENT = 25.0, 75.0
#: From so many times the guideline on nothing that is told of the wearer's joints is to be relied on. It is 250 N, a third of what a person
#: weighs, or 750 N m, all of it on a lever of a metre: what moves such a body is not its joints. The motions that come along leave at most
#: 0 N and 30 N m, recorded walks that were handed in with signs and tilt in order up to 40 N m.
BEYOND = 10.0


def unreliable(name: str, residual: NDArray[np.float64], doubts: Sequence[str]) -> str | None:
    """Return in a sentence that and why moments and metabolic power are not to be relied on; None where residuals do not say so.

    Args:
        name: Of the gait.
        residual: Of the wearer alone, without machine or load: x, z [N], about -y [N m], shape (n, 3).
        doubts: What may be wrong with the gait's angles.
    """
    force, moment = float(np.hypot(residual[:, 0], residual[:, 1]).max()), float(np.abs(residual[:, 2]).max())
    if force <= BEYOND * FORCE and moment <= BEYOND * MOMENT:
        return None
    why = f"perhaps because {', and because '.join(doubts)}" if doubts else "are unit, clock and columns of its angles right?"
    return (
        f"{name}: moments and metabolic power of this gait are not to be relied on: even without machine and load {force:.0f} N and "
        f"{moment:.0f} N m are left at the pelvis that no ground gives ({FORCE:.0f} N and {MOMENT:.0f} N m are acceptable); {why}"
    )
