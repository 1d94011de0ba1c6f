"""A vessel that leaks from the moment its supply is shut, which no column records: where that moment is."""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.observed import CylinderRun

#: A fall smaller than this, in units of the noise, tells no moment.
CLEAR = 100.0
#: The pressure held if this share of the fall took ...
FIRST, HALF = 0.01, 0.5
#: ... longer than this share of the time in which half of it is gone: a leak falls fastest at first, and takes a fiftieth.
HELD = 0.1


def from_the_fall(run: CylinderRun) -> CylinderRun:
    """Return a run without the time at its beginning in which something outside held the pressure up; itself where nothing did.

    Args:
        run: Of a cylinder whose valve and piston never move.
    """
    start = 0
    for values, noise in zip(run.pressure, run.noise, strict=True):
        if values is None or np.isfinite(values).sum() < 20:
            continue
        filled = np.interp(run.time, run.time[np.isfinite(values)], values[np.isfinite(values)])
        first = float(np.median(filled[:5]))
        fall = first - float(np.median(filled[-5:]))
        if fall < CLEAR * max(noise, 1.0):
            continue
        above = first - filled
        left = int(np.flatnonzero(above < FIRST * fall)[-1]) + 1
        half = int(np.argmax(above > HALF * fall))
        if run.time[left - 1] - run.time[0] > HELD * (run.time[half] - run.time[0]) and left < half:
            start = max(start, left)
    return run.part(start, len(run.time)) if start else run
