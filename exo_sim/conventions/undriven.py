"""Machines that nothing drives: a pendulum that is let go."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


def drives(force: NDArray[np.float64]) -> bool:
    """Return whether a recorded force drives anything: one that is zero wherever it was recorded says that none does."""
    return bool(np.any(np.nan_to_num(force)))


def is_undriven(recording: Recording, rig: Rig) -> bool:
    """Return whether a rig has no cylinder and no outside force on a joint was recorded but zeros: without its column there is none."""
    outside = (values for key, values in recording.columns.items() if key.endswith(".external_force"))
    return not rig.cylinders and not any(drives(values) for values in outside)
