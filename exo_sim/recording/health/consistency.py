"""Columns against one another: a velocity must be the derivative of its position."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.noise import Noise
from exo_sim.recording.table import Recording

_STRETCH = 20


def check(recording: Recording, noise: Mapping[str, Noise], spoilt: Collection[str] = ()) -> list[Finding]:
    """Compare what is recorded twice, but for the columns that are known to be spoilt."""
    found: list[Finding] = []
    for part in recording.parts():
        twice = (f"{part}.position", f"{part}.velocity")
        if all(key in recording and key not in spoilt for key in twice):
            found += _velocity(recording, part, noise)
    return found


def _velocity(recording: Recording, part: str, noise: Mapping[str, Noise]) -> list[Finding]:
    """Compare the way between samples some way apart with the velocity summed up over it."""
    key, time = f"{part}.velocity", recording.time
    position, velocity = recording[f"{part}.position"], recording[key]
    if len(time) < 10 * _STRETCH:
        return []
    usual = float(np.median(np.diff(time)))
    each = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time)
    unseen = 0.5 * (velocity[2:] - 2.0 * velocity[1:-1] + velocity[:-2]) * usual  # what a slow clock cannot sum up
    if np.nanstd(unseen) > 0.1 * np.nanstd(each):
        return []
    each[np.diff(time) > 3.0 * usual] = np.nan
    spans = each[: len(each) // _STRETCH * _STRETCH].reshape(-1, _STRETCH).sum(axis=1)
    way = (position[_STRETCH::_STRETCH] - position[:-_STRETCH:_STRETCH])[: len(spans)]
    good = np.isfinite(spans) & np.isfinite(way)
    spans, way = spans[good], way[good]
    unsure = 3.0 * noise[f"{part}.position"].std
    if len(way) < 10 or np.quantile(np.abs(way), 0.9) < 5.0 * unsure or not np.any(spans):
        return []
    factor = float(spans @ way / (way @ way))
    likeness = float(spans @ way / np.sqrt((spans @ spans) * (way @ way)))
    if likeness > 0.9 and 0.9 < factor < 1.1:
        return []
    if abs(likeness) > 0.9:
        says = f'"{key}" is {factor:.3g} times the derivative of "{part}.position"; is its sign and unit right?'
    elif likeness > 0.7 and 0.7 < factor < 1.4:
        return []
    else:
        says = f'"{key}" does not follow the derivative of "{part}.position" (correlation {likeness:.2f})'
    return [Finding(key, "inconsistent", says, severity="fault", use="set aside")]
