"""Runs of one cylinder for tests that ask nothing of a rig."""

from __future__ import annotations

from typing import Any

import numpy as np

from exo_sim.diagnosis.data.cylinder_run import CylinderRun

STEP = 1e-3


def run_of(*pressure: np.ndarray | None, time: np.ndarray | None = None, **more: Any) -> CylinderRun:
    """Return a cylinder at rest under these one or two pressures, a sample a millisecond; `more` replaces what else a run has."""
    n = next(len(values) for values in pressure if values is not None)
    first, second = (*pressure, None)[:2]
    fields: dict[str, Any] = {
        "time": np.arange(n) * STEP if time is None else time, "command": np.zeros(n), "length": np.full(n, 0.1), "speed": np.zeros(n),
        "supply": None, "exhaust": None, "supply_temperature": None, "force": None, "commanded": False, "noise": (0.0, 0.0),
        "breaks": (0,),
    }  # fmt: skip
    return CylinderRun("recording", "piston", pressure=(first, second), **{**fields, **more})
