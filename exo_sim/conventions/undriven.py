"""Machines that nothing drives: a pendulum that is let go, of which nothing but the position was recorded."""

from __future__ import annotations

from exo_sim.recording.table import Recording
from exo_sim.rig import Rig


def is_undriven(recording: Recording, rig: Rig) -> bool:
    """Return whether a rig has no cylinder and no outside force on a joint was recorded: where that column is absent there is none."""
    return not rig.cylinders and not any(key.endswith(".external_force") for key in recording.columns)
