"""A diagnosis for the rerun viewer: recorded, simulated before and after, their differences, and when the mismatch was where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.findings import Series
from exo_sim.diagnosis.result import Diagnosis
from exo_sim.recording.rrd_file import Lane, write_rrd
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.machine_scene import recorded_scene

Array = NDArray[np.float64]

#: Between two recordings on the one clock of the file [s].
PAUSE = 1.0
#: Samples that the viewer is given of a long recording.
MOST_SHOWN = 150_000


def write_comparison(path: Path, diagnosis: Diagnosis, recordings: Sequence[Recording] = (), rig: Rig | None = None) -> None:
    """Write `comparison.rrd`.

    Several recordings follow each other on one clock, with a lane that names them.

    Args:
        path: Where to.
        diagnosis: Its series and located spans are shown.
        recordings: The recordings as they were read: their other signals are shown as well.
        rig: The machine, to draw it where it was recorded to be; not drawn when None.

    Raises:
        OutputError: the file cannot be written.
    """
    names = list(dict.fromkeys([*(series.recording for series in diagnosis.series), *(r.name for r in recordings)]))
    measured = {recording.name: recording for recording in recordings}
    shifts: dict[str, float] = {}
    pieces: dict[str, list[Recording]] = {"recorded": [], "before": [], "after": []}
    end = None
    for name in names:
        own = [series for series in diagnosis.series if series.recording == name]
        whole_clock = measured[name].time if name in measured else own[0].time
        shifts[name] = 0.0 if end is None else end + PAUSE - float(whole_clock[0])
        shown = measured.get(name, Recording(name, whole_clock, {}, {})).thinned(MOST_SHOWN)
        for kind, columns, units in _columns(own, shown):
            pieces[kind].append(Recording(name, shown.time + shifts[name], columns, units))
        end = float(whole_clock[-1]) + shifts[name]
    if not pieces["recorded"]:
        return
    metadata = {"verdict": diagnosis.verdict, "rig": diagnosis.rig}
    whole = {kind: _one_after_another(diagnosis.rig, parts, metadata).thinned(MOST_SHOWN) for kind, parts in pieces.items()}
    overlays: dict[str, Recording] = {kind: one for kind, one in whole.items() if kind != "recorded" and one.columns}
    scene = None if rig is None else recorded_scene(whole["recorded"], rig)
    write_rrd(path, whole["recorded"], scene, overlays=overlays, lanes=lanes(diagnosis, shifts, pieces["recorded"]))


def lanes(diagnosis: Diagnosis, shifts: Mapping[str, float], recorded: Sequence[Recording]) -> dict[str, Lane]:
    """Return a lane for each located balance, one for held-out time, and one for the names of several recordings."""
    found: dict[str, list[tuple[float, str]]] = {}
    if len(recorded) > 1:
        found["recording"] = [(float(r.time[0]), r.name) for r in recorded]
    for place in diagnosis.located:
        shift = shifts.get(place.recording or next(iter(shifts)), 0.0)
        lane = found.setdefault(f"{place.where} {place.equation}".replace("/", " "), [])
        for start, stop in place.when:
            lane += [(start + shift, place.regime or "mismatch"), (stop + shift, "")]
    kept: list[tuple[float, str]] = []
    for recording in recorded:
        shift = shifts[recording.name]
        spans = diagnosis.held_out.get(recording.name, ())
        kept += [item for a, b in spans for item in ((a + shift, "held out"), (b + shift, ""))]
    if kept:
        found["held out"] = kept
    return {name: sorted(lane) for name, lane in found.items() if lane}


def _columns(own: Sequence[Series], measured: Recording) -> list[tuple[str, dict[str, Array], dict[str, str]]]:
    """Return the columns of one recording as recorded, before and after, on its clock."""
    clock, recorded, units = measured.time, dict(measured.columns), dict(measured.units)
    before, after = {}, {}
    for series in own:
        units[series.signal] = series.unit
        recorded[series.signal] = _on(clock, series.time, series.recorded)
        before[series.signal] = _on(clock, series.time, series.before)
        after[series.signal] = _on(clock, series.time, series.after)
    return [("recorded", recorded, units), ("before", before, units), ("after", after, units)]


def _on(clock: Array, time: Array, values: Array) -> Array:
    """Return values on another clock; what is missing stays missing."""
    if len(clock) == len(time) and np.array_equal(clock, time):
        return values
    near = np.clip(np.searchsorted(time, clock), 1, len(time) - 1)
    near -= clock - time[near - 1] < time[near] - clock
    found = np.interp(clock, time, np.nan_to_num(values))
    outside = (clock < time[0]) | (clock > time[-1]) | ~np.isfinite(values[near])
    return np.where(outside, np.nan, found)


def _one_after_another(name: str, parts: Sequence[Recording], metadata: Mapping[str, str]) -> Recording:
    keys = list(dict.fromkeys(key for part in parts for key in part.columns))
    units = {key: next(part.units[key] for part in parts if key in part.columns) for key in keys}
    columns = {
        key: np.concatenate([part.columns.get(key, np.full(len(part.time), np.nan)) for part in parts]) for key in keys
    }
    return Recording(name, np.concatenate([part.time for part in parts]), columns, units, dict(metadata))
