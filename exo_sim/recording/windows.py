"""Stretches of a clock without jumps, and windows inside them that start where the pressures are quiet.

A measured pressure is a good initial condition only while it changes slowly: during flow the two ends of a hose differ, and the time
jitter of a sample becomes a pressure error.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

Array = NDArray[np.float64]

#: The clock jumps where a step is longer than this many usual ones; no prediction runs across a jump ...
JUMP = 20.0
#: ... nor across a hole in a channel that is longer than this [s].
HOLE = 0.03
#: Samples over which the range of a pressure is taken.
RANGE_SAMPLES = 30
#: A window holds so many samples at least.
FEWEST_IN_WINDOW = 5
#: How far a window's start may be moved to where the pressures are quieter, in lengths of a window.
QUIET_REACH = 0.25


def clock_breaks(time: Array, mended: Sequence[float] = ()) -> tuple[int, ...]:
    """Return the indices at which the clock has jumped, 0 first.

    Args:
        time: [s], shape (n,).
        mended: Times at which it was mended, which is a jump as well (`Recording.breaks`) [s].
    """
    step = np.diff(time)
    usual = float(np.median(step)) if step.size else 1.0
    return tuple(sorted({0, *(int(i) + 1 for i in np.flatnonzero(step > JUMP * usual)), *mended_at(time, mended)}))


def mended_at(time: Array, mended: Sequence[float]) -> list[int]:
    """Return the first samples after a clock was mended; arguments as of `clock_breaks`."""
    if not mended:
        return []
    before = 0.5 * float(np.median(np.diff(time)))
    return [int(at) for at in np.searchsorted(time, np.asarray(mended) - before) if at < len(time)]


def stretch_starts(time: Array, *channels: Array | None, mended: Sequence[float] = ()) -> tuple[int, ...]:
    """Return the indices at which a stretch begins: jumps of the clock (`clock_breaks`), and both ends of every hole in a channel."""
    edges = set(clock_breaks(time, mended))
    for values in channels:
        if values is not None:
            edges |= {edge for hole in holes(time, values) for edge in hole}
    return tuple(sorted(edge for edge in edges if edge < len(time)))


def holes(time: Array, values: Array) -> list[tuple[int, int]]:
    """Return the holes of a channel, first and past the last sample of each: too long to be bridged (single samples are interpolated)."""
    there = np.isfinite(values)
    if there.all():
        return []
    least = max(3, int(HOLE / max(float(np.median(np.diff(time))), 1e-9))) if len(time) > 1 else 3
    bad = np.concatenate([[0], (~there).astype(int), [0]])
    turns = np.flatnonzero(np.diff(bad))
    return [(int(begin), int(end)) for begin, end in zip(turns[::2], turns[1::2], strict=True) if end - begin >= least]


def local_range(pressures: Iterable[Array | None], n: int) -> Array:
    """Return the range of each measured pressure around every one of `n` samples, summed [Pa], shape (n,); infinite near a hole."""
    total = np.zeros(n)
    for values in pressures:
        if values is not None:
            hole = ~np.isfinite(values)
            filled = np.where(hole, 0.0, values)
            total += maximum_filter1d(filled, RANGE_SAMPLES) - minimum_filter1d(filled, RANGE_SAMPLES)
            total[maximum_filter1d(hole, RANGE_SAMPLES)] = np.inf
    return total


def window_starts(time: Array, begin: int, end: int, seconds: float, restless: Array) -> list[int]:
    """Return the first samples of the windows of about `seconds` that a stretch without breaks is cut into, longer on a slow clock.

    Args:
        time: Of all samples, shape (n,).
        begin, end: The stretch, its end excluded.
        seconds: Length of a window; infinite for one window.
        restless: Result of `local_range`, shape (n,).
    """
    span = time[end - 1] - time[begin] if end > begin else 0.0
    count = max(1, min(int(round(span / seconds)), (end - begin) // FEWEST_IN_WINDOW))
    even = np.searchsorted(time[begin:end], time[begin] + span * np.arange(count) / count) + begin
    marks = [*(int(cut) for cut in even), end]
    found = marks[:-1]
    for w in range(1, count):
        low = marks[w] - int(QUIET_REACH * (marks[w] - marks[w - 1]))
        high = marks[w] + int(QUIET_REACH * (marks[w + 1] - marks[w]))
        quietest = low + np.flatnonzero(restless[low : high + 1] == restless[low : high + 1].min())
        found[w] = int(quietest[np.argmin(np.abs(quietest - marks[w]))])
    return found
