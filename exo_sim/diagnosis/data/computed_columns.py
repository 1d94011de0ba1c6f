"""Columns that were computed or smoothed, and not just measured: they have no noise, and what a sensor could show takes its place.

A recording of a simulation differs from another simulation of the same by errors of integration, however small; held against a noise that
does not exist they would be a million times too large.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.recordings import COMPUTED, SENSOR_SHOWS
from exo_sim.recording.noise import FEWEST_FOR_NOISE, finite, white_noise
from exo_sim.recording.table import Recording


def is_computed(values: NDArray[np.float64]) -> bool:
    """Return whether a column, shape (n,), varies with less noise than any instrument has; too few samples do not show that."""
    there = finite(values)
    return there.size >= FEWEST_FOR_NOISE and float(np.ptp(there)) > 0.0 and white_noise(values) < COMPUTED * _reach(there)


def was_computed(table: Recording) -> bool:
    """Return whether everything measured in a recording that varies was computed: one fine encoder alone may be as quiet.

    Of a position, whose zero is anybody's choice, what it varies counts.
    """
    is_any = False
    for key, values in table.columns.items():
        there = finite(values) if _is_measured(key) else values[:0]
        if there.size < FEWEST_FOR_NOISE or not np.ptp(there) > 0.0:
            continue
        is_any = True
        if not is_computed(there - np.median(there) if key.endswith(".position") else there):
            return False
    return is_any


def shown_noise(noise: float, values: NDArray[np.float64], of_computed: bool) -> float:
    """Return the noise that errors of a column are held against.

    Args:
        noise: What its samples show, one standard deviation.
        values: The column, shape (n,), NaN where missing.
        of_computed: Whether the recording that it is of was computed as a whole.
    """
    replaced = of_computed and is_computed(values)
    return max(noise, SENSOR_SHOWS * _reach(finite(values))) if replaced else noise


def computed(tables: Iterable[Recording], signals: Sequence[str]) -> tuple[str, ...]:
    """Return those of some signals that were computed in every recording that holds them."""
    tables = tuple(tables)
    known = {table.name: was_computed(table) for table in tables}
    found = []
    for key in signals:
        held = [table for table in tables if key in table]
        if held and all(known[table.name] and is_computed(table.columns[key]) for table in held):
            found.append(key)
    return tuple(found)


def _is_measured(key: str) -> bool:
    signal = key.rsplit(".", 1)[-1]
    return signal in ("position", "external_force") or signal.startswith("pressure")


def remark(columns: Sequence[str]) -> str:
    """Return what to say of columns that were computed."""
    return (
        f"{', '.join(columns)}: without noise, so smoothed or computed and not as measured; errors are held against what a sensor shows, "
        f"{100.0 * SENSOR_SHOWS:g} % of its range"
    )


def _reach(there: NDArray[np.float64]) -> float:
    return max(float(there.max(initial=0.0)), -float(there.min(initial=0.0)))
