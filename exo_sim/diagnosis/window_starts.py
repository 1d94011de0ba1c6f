"""Where predictions begin anew: about every so many seconds, each where the gas is quiet nearby.

Where gas flows, no sensor tells the state to begin with: a hose's two ends differ, and a sample's jitter is pressure.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

Array = NDArray[np.float64]

#: Samples over which a pressure must be quiet.
_AROUND = 30
#: How far a window's start may be moved to where the gas is quieter, in lengths of a window.
QUIET_REACH = 0.25


def unrest(pressures: Iterable[Array | None], n: int) -> Array:
    """Return by how much measured pressures change around each of `n` samples, together [Pa], shape (n,)."""
    total = np.zeros(n)
    for values in pressures:
        if values is not None:
            hole = ~np.isfinite(values)
            filled = np.where(hole, 0.0, values)
            total += maximum_filter1d(filled, _AROUND) - minimum_filter1d(filled, _AROUND)
            total[maximum_filter1d(hole, _AROUND)] = np.inf
    return total


def cuts(time: Array, begin: int, end: int, seconds: float, restless: Array) -> list[int]:
    """Return the first samples of the windows of about `seconds` that a stretch without breaks is cut into.

    Args:
        time: Of all samples, shape (n,).
        begin, end: The stretch, its end excluded.
        seconds: As long as that; infinite for one window.
        restless: What `unrest` says, shape (n,).
    """
    span = time[end - 1] - time[begin] if end > begin else 0.0
    count = max(1, int(round(span / seconds)))
    even = np.searchsorted(time[begin:end], time[begin] + span * np.arange(count) / count) + begin
    marks = [*(int(cut) for cut in even), end]
    found = marks[:-1]
    for w in range(1, count):
        low = marks[w] - int(QUIET_REACH * (marks[w] - marks[w - 1]))
        high = marks[w] + int(QUIET_REACH * (marks[w + 1] - marks[w]))
        quietest = low + np.flatnonzero(restless[low : high + 1] == restless[low : high + 1].min())
        found[w] = int(quietest[np.argmin(np.abs(quietest - marks[w]))])
    return found
