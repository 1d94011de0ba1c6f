"""Runs of rows: finding them, and turning them into what a finding lists."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.data_quality_finding import MOST_SPANS
from exo_sim.recording.instants import instant

Rows = NDArray[np.intp]


def runs(mask: NDArray[np.bool_]) -> Rows:
    """Return the half-open runs of True, shape (m, 2)."""
    padded = np.zeros(len(mask) + 2, dtype=np.int8)
    padded[1:-1] = mask
    edges = np.flatnonzero(np.diff(padded))
    return edges.reshape(-1, 2)


def listed(
    spans: Rows, time: NDArray[np.float64]
) -> tuple[tuple[tuple[int, int], ...], tuple[tuple[float, float], ...]]:
    """Return the first spans as rows and as times."""
    some = spans[:MOST_SPANS]
    rows = tuple((int(start), int(stop)) for start, stop in some)
    return rows, tuple((float(time[start]), float(time[stop - 1])) for start, stop in rows)


def where(spans: Rows, time: NDArray[np.float64]) -> str:
    """Return where the spans are: `in 3 spans, first rows 11-20 (0.010-0.019 s)`."""
    start, stop = int(spans[0][0]), int(spans[0][1])
    begins, ends = (instant(float(time[at]), float(time[0]), float(time[-1])) for at in (start, stop - 1))
    first = f"rows {start + 1}-{stop} ({begins}-{ends} s)"
    if stop == start + 1:
        first = f"row {start + 1} ({begins} s)"
    return f"in {first}" if len(spans) == 1 else f"in {len(spans)} spans, first {first}"
