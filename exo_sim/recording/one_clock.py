"""Signals that were logged each on a clock of its own, brought onto one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.recording import columns
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.signals import VALVE_COMMANDS


def on_one_clock(
    path: Path, series: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]], findings: list[Finding]
) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """Put all signals on the clock of the longest; commands are held, the rest is interpolated.

    Args:
        path: The file, for messages.
        series: Key to times [s] and values, shape (n,) each.
        findings: What was done is added.

    Raises:
        RecordingError: no signal has a clock that increases.
    """
    time = max((times for times, _ in series.values()), key=len)
    values = {}
    for key, (times, numbers) in series.items():
        if len(times) == len(time) and np.array_equal(times, time):
            values[key] = numbers
        elif len(times) < 2 or not (np.diff(times) > 0).all():
            says = f'"{key}" has {len(times)} samples on a clock of its own that does not increase; it was set aside'
            findings.append(Finding(key, "clock", says, severity="warning", use="set aside"))
        else:
            if columns.signal_of(key).name in VALVE_COMMANDS:
                at = np.searchsorted(times, time, side="right") - 1
                values[key] = np.where(at >= 0, numbers[np.maximum(at, 0)], np.nan)
            else:
                values[key] = np.interp(time, times, numbers, left=np.nan, right=np.nan)
            if _only_turns(time, times, numbers):
                continue
            says = (
                f'"{key}" has {len(times)} samples on a clock of its own; brought onto the clock of the longest signal'
            )
            findings.append(Finding(key, "clock", says, severity="info", use="repaired"))
    if not values:
        raise RecordingError(f'"{path}": no signal in it has a clock that increases')
    return time, values


def _only_turns(time: NDArray[np.float64], times: NDArray[np.float64], numbers: NDArray[np.float64]) -> bool:
    """Return whether what a signal lacks of a clock lies between samples that are equal: then nothing of it is lost."""
    if times[0] != time[0] or times[-1] != time[-1]:
        return False
    at = np.searchsorted(time, times)
    return bool(np.array_equal(time[at], times) and (numbers[:-1] == numbers[1:])[np.diff(at) > 1].all())
