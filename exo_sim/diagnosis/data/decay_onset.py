"""The onset of a pressure decay: a vessel leaks from the moment its supply is shut, which no column records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.policy.recordings import CLEAR_FALL, FALL_BEGINS, FALL_LEVEL, FEWEST_OF_FALL, HELD_OPEN, QUIET_START


def from_decay_onset(run: CylinderRun) -> CylinderRun:
    """Return a run from the moment its pressures were left to decay; the run itself where they were from the beginning.

    Gas that was held until then is as warm as its walls.

    Args:
        run: Of a cylinder whose valve and piston never move.
    """
    start = 0
    for values, noise in zip(run.pressure, run.noise, strict=True):
        if values is None or np.isfinite(values).sum() < FEWEST_OF_FALL:
            continue
        filled = np.interp(run.time, run.time[np.isfinite(values)], values[np.isfinite(values)])
        first = float(np.median(filled[:FALL_LEVEL]))
        fall = first - float(np.median(filled[-FALL_LEVEL:]))
        if fall < CLEAR_FALL * max(noise, 1.0):
            continue
        above = first - filled
        left = int(np.flatnonzero(above < FALL_BEGINS * fall)[-1]) + 1
        half = int(np.argmax(above > 0.5 * fall))
        if left > 2 * FALL_LEVEL and run.time[left - 1] - run.time[0] > HELD_OPEN * (run.time[half] - run.time[0]) and left < half:
            start = max(start, left)
    if not start:
        return run
    return replace(run.part(start, len(run.time)), settled=bool(run.time[start] - run.time[0] >= QUIET_START))
