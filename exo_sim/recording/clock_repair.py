"""Putting the clock of a raw table in order: strictly increasing, with everything that was done about it said."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.recording.data_quality_finding import MOST_SPANS, Finding
from exo_sim.recording.instants import instant

#: A clock that jumps back so far that more than this share of the rows would be lost is taken for two recordings in one
#: file, and the longest is kept.
MOST_LOST = 0.1
#: A clock that stands still in more than this share of the rows has steps that its digits do not show.
COARSE = 0.4
#: A step this small, relative to the usual one, is none.
STANDSTILL = 1e-6


def in_order(name: str, time: NDArray[np.float64]) -> tuple[NDArray[np.intp] | slice, list[Finding], tuple[float, ...]]:
    """Choose the rows that make the clock strictly increasing.

    Args:
        name: The file, for messages.
        time: Seconds as recorded, shape (n,).

    Returns:
        The rows to keep, in order; what was found; and the times at which the clock was mended, which no prediction
        should run across.

    Raises:
        RecordingError: no time in it.
    """
    findings: list[Finding] = []
    rows = np.arange(len(time))
    missing = ~np.isfinite(time)
    if missing.any():
        if missing.all():
            raise RecordingError(f'"{name}": column "time" holds no numbers')
        count, first = int(missing.sum()), int(np.argmax(missing))
        rows = rows[~missing]
        says = f'"time" has no number in {in_rows(count)}, first row {first + 1}; dropped'
        findings.append(Finding("time", "clock", says, severity="warning", use="repaired"))
    steps = np.diff(time[rows])
    if len(steps) and (steps > _least(steps)).all():
        return (slice(None) if not missing.any() else rows), findings, ()
    if len(steps) and (steps <= 0).all() and (steps < 0).mean() > 0.5:
        rows, steps = rows[::-1], -steps[::-1]
        says = '"time" runs backwards in all rows; the rows were turned round'
        findings.append(Finding("time", "clock", says, severity="warning", use="repaired"))
    kept, breaks = _increasing(time, rows, steps, findings)
    return kept, findings, breaks


def _increasing(
    time: NDArray[np.float64], rows: NDArray[np.intp], steps: NDArray[np.float64], findings: list[Finding]
) -> tuple[NDArray[np.intp], tuple[float, ...]]:
    clock = time[rows]
    latest = np.maximum.accumulate(clock)
    later = np.concatenate(([True], clock[1:] - latest[:-1] > _least(np.abs(steps))))
    back = np.flatnonzero(steps < 0)
    if not len(back):
        if not later.all():
            _say_repeated(clock, rows, ~later, findings)
        return rows[later], ()
    first = back[0]
    times = tuple((float(clock[at + 1]), float(clock[at])) for at in back[:MOST_SPANS])
    before, after = (instant(float(clock[at]), float(clock.min()), float(clock.max())) for at in (first, first + 1))
    where = f"row {rows[first] + 1 + 1} ({before} s to {after} s)"
    if (~later).mean() <= MOST_LOST:
        says = (
            f'"time" steps back {_times(len(back))}, first at {where}; '
            f"{in_rows(int((~later).sum()))} not later than one before: dropped"
        )
        findings.append(Finding("time", "clock", says, times=times, severity="warning", use="repaired"))
        mended = np.flatnonzero(np.diff(np.flatnonzero(later)) > 1)
        return rows[later], tuple(float(t) for t in clock[later][mended + 1])
    edges = np.concatenate(([0], back + 1, [len(rows)]))
    longest = int(np.argmax(np.diff(edges)))
    piece = slice(edges[longest], edges[longest + 1])
    kept = f"{in_rows(edges[longest + 1] - edges[longest])} from row {rows[piece][0] + 1} on"
    says = (
        f'"time" steps back {_times(len(back))}, first at {where}: several recordings in one file; '
        f"the longest was kept ({kept}), the others set aside"
    )
    findings.append(Finding("time", "clock", says, times=times, severity="warning", use="set aside"))
    clock, rows = clock[piece], rows[piece]
    later = np.concatenate(([True], np.diff(clock) > _least(np.diff(clock))))
    if not later.all():
        _say_repeated(clock, rows, ~later, findings)
    return rows[later], ()


def _least(steps: NDArray[np.float64]) -> float:
    """Return the step from which a clock moves on [s]: less is rounding, of which no speed can be had."""
    forward = steps[steps > 0]
    return STANDSTILL * float(np.median(forward)) if len(forward) else 0.0


def _say_repeated(
    clock: NDArray[np.float64], rows: NDArray[np.intp], repeated: NDArray[np.bool_], findings: list[Finding]
) -> None:
    at = np.flatnonzero(repeated)
    when = instant(float(clock[at[0]]), float(clock[0]), float(clock[-1]))
    coarse = "; was it written with too few digits?" if len(at) > COARSE * len(clock) else ""
    says = f'"time" stands still in {in_rows(len(at))}, first row {rows[at[0]] + 1} ({when} s); only the first of each was kept{coarse}'
    times = tuple((float(clock[i]), float(clock[i])) for i in at[:MOST_SPANS])
    findings.append(Finding("time", "clock", says, times=times, severity="warning", use="repaired"))


def in_rows(count: int) -> str:
    """Return a number of rows in words."""
    return f"{count} row" if count == 1 else f"{count} rows"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
