"""The filter that every term of a balance of forces passes, and the samples of a long recording that are kept behind it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.policy.recordings import FILTER_ENDS
from exo_sim.recording.filters import EvenClock, gaussian_smoothed, gaussian_width

Array = NDArray[np.float64]

#: Motion and forces are smoothed alike over this time, unless another is asked for [s].
SMOOTHING = 0.031
#: Of a long recording at most so many samples are kept, while the filter spans at least so many of them.
MOST_SAMPLES, FEWEST_IN_FILTER = 400_000, 6


def smoothing_width(time: Array, asked: float = 0.0) -> float:
    """Return the width of the filter on this clock [s]: the usual, or what is asked for (see `motion_runs`); no less than the least."""
    return _width(float(np.median(np.diff(time), overwrite_input=True)), asked)


def least_width(time: Array) -> float:
    """Return the least width of a filter on this clock [s]."""
    return FEWEST_IN_FILTER * float(np.median(np.diff(time), overwrite_input=True))


def _width(usual: float, asked: float) -> float:
    return max(FEWEST_IN_FILTER * usual, asked or SMOOTHING)


def reach(time: Array, asked: float = 0.0) -> int:
    """Return how many samples to either side the filter takes from on this clock; `asked` as of `smoothing_width`."""
    step = float(np.median(np.diff(time), overwrite_input=True))
    return max(1, math.ceil(FILTER_ENDS * gaussian_width(_width(step, asked)) / step))


def smoothed_alike(time: Array, values: Array, clock: EvenClock | None = None, asked: float = 0.0) -> Array:
    """Return values behind the filter of the balance, shape (n,).

    Args:
        time, values: Shape (n,).
        clock: That of `time`, if it is known already.
        asked: As of `smoothing_width`.
    """
    clock = clock or EvenClock.of(time)
    return gaussian_smoothed(time, values, _width(clock.usual, asked), clock)


def before_filter(weights: sparse.csr_array, time: Array, clock: EvenClock, asked: float = 0.0) -> sparse.csr_array:
    """Return weights that take from values what the given ones take from the same values behind the filter of the balance.

    Args:
        weights: Of the filtered values, shape (m, n).
        time: Their clock, shape (n,) [s]; `clock` is that of it.
        asked: As of `smoothing_width`.
    """
    width = _width(clock.usual, asked)
    if clock.even is None:
        return sparse.csr_array(weights @ _filter(time, clock.usual, width))
    even = clock.even
    return sparse.csr_array(weights @ _interpolation(time, even) @ _filter(even, clock.usual, width) @ _interpolation(even, time))


def _filter(even: Array, usual: float, width: float) -> sparse.csr_array:
    """Return the filter on an even clock as a matrix, shape (n, n): what it answers to one value, and at the ends the last value held."""
    n = len(even)
    impulse = np.zeros(n)
    impulse[n // 2] = 1.0
    answer = gaussian_smoothed(even, impulse, width, EvenClock(usual, None))
    reach = n // 2 - int(np.flatnonzero(answer)[0])
    offsets = np.arange(-reach, reach + 1, dtype=np.int32)
    column = np.arange(n, dtype=np.int32)[:, None] + offsets
    inside = (column >= 0) & (column < n)
    first = np.concatenate([[0], np.cumsum(inside.sum(axis=1))])
    data = np.broadcast_to(answer[n // 2 + offsets], inside.shape)[inside]
    found = sparse.csr_array((data, column[inside], first.astype(np.int32)), shape=(n, n))
    beyond = answer.sum() - found.sum(axis=1)
    rows = np.flatnonzero(np.minimum(np.arange(n), np.arange(n)[::-1]) < reach)
    found.data[np.where(rows < n // 2, first[rows], first[rows + 1] - 1)] += beyond[rows]
    return found


def _interpolation(at: Array, time: Array) -> sparse.csr_array:
    """Return the matrix that interpolates values on a clock, shape (n,), to other times, shape (m,): shape (m, n)."""
    first = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    share = np.clip((at - time[first]) / (time[first + 1] - time[first]), 0.0, 1.0)
    row = np.arange(len(at))
    places = (np.concatenate([row, row]), np.concatenate([first, first + 1]))
    return sparse.csr_array((np.concatenate([1.0 - share, share]), places), shape=(len(at), len(time)))


def stride(time: Array) -> int:
    """Return of how many samples of this clock a balance keeps one."""
    spanned = smoothing_width(time) / float(np.median(np.diff(time), overwrite_input=True))
    return max(1, min(-(-len(time) // MOST_SAMPLES), int(spanned / FEWEST_IN_FILTER + 1e-9)))


def thinned(values: Array, every: int) -> Array:
    """Return one of every so many samples, shape (ceil(n / every),), as an array of its own."""
    return np.ascontiguousarray(values[::every])


def on_clock(run: MotionRun, time: Array, values: Array) -> Array:
    """Return values on a recording's clock at the samples that a balance of it keeps, shape of `run.time`."""
    return values if len(values) == len(run.time) else np.interp(run.time, time, values)


def smoothed_on_clock(run: MotionRun, time: Array, values: Array) -> Array:
    """Return values on a recording's clock as a balance has them: smoothed, at the samples that it keeps."""
    return on_clock(run, time, smoothed_alike(time, values, asked=run.smoothing))
