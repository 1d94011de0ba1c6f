"""The filter that every term of a balance of forces passes, and the samples of a long recording that are kept behind it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.recording.filters import EvenClock, gaussian_smoothed

Array = NDArray[np.float64]

#: Motion and forces are smoothed alike over this time [s].
SMOOTHING = 0.031
#: Of a long recording at most so many samples are kept, while the filter spans at least so many of them.
MOST_SAMPLES, FEWEST_IN_FILTER = 400_000, 6


def smoothing_width(time: Array) -> float:
    """Return the width of the filter on this clock [s]."""
    return _width(float(np.median(np.diff(time))))


def _width(usual: float) -> float:
    return max(SMOOTHING, FEWEST_IN_FILTER * usual)


def smoothed_alike(time: Array, values: Array, clock: EvenClock | None = None) -> Array:
    """Return values behind the filter of the balance, shape (n,); `clock` is that of `time`, if it is known already."""
    clock = clock or EvenClock.of(time)
    return gaussian_smoothed(time, values, _width(clock.usual), clock)


def stride(time: Array) -> int:
    """Return of how many samples of this clock a balance keeps one."""
    spanned = smoothing_width(time) / float(np.median(np.diff(time)))
    return max(1, min(-(-len(time) // MOST_SAMPLES), int(spanned / FEWEST_IN_FILTER + 1e-9)))


def thinned(values: Array, every: int) -> Array:
    """Return one of every so many samples, shape (ceil(n / every),), as an array of its own."""
    return np.ascontiguousarray(values[::every])


def on_clock(run: MotionRun, time: Array, values: Array) -> Array:
    """Return values on a recording's clock at the samples that a balance of it keeps, shape of `run.time`."""
    return values if len(values) == len(run.time) else np.interp(run.time, time, values)


def smoothed_on_clock(run: MotionRun, time: Array, values: Array) -> Array:
    """Return values on a recording's clock as a balance has them: smoothed, at the samples that it keeps."""
    return on_clock(run, time, smoothed_alike(time, values))
