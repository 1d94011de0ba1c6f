"""The walk on the mean stride from which a causal controller learns what belongs to which phase."""

from __future__ import annotations

import numpy as np

from exo_sim.control.causal import Calibration, strap_forces
from exo_sim.control.least_load import LeastLoad
from exo_sim.simulation.rehearsal import cycle_mean
from exo_sim.simulation.walk import Walk


def calibrated(plan: LeastLoad, walk: Walk, settling: float) -> Calibration:
    """Return what a walk with the best torques of a plan showed.

    Args:
        plan: As rehearsed.
        walk: With its demand.
        settling: Cycles at the start that are left out.
    """
    columns = walk.columns
    angles = np.stack([columns[f"{name}.position"] for name in ("hip_l", "hip_r", "knee_l", "knee_r")], axis=1)
    forces = np.moveaxis(strap_forces(columns, walk.straps), -1, 0)
    return Calibration(plan, walk.straps, walk.motion.period, cycle_mean(walk, angles, settling), cycle_mean(walk, forces, settling))
