"""Signals over time as figures: one panel for each kind of signal and unit, read in the units that people read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exo_sim.api.figure import Picture
from exo_sim.errors import RecordingError, nearest
from exo_sim.recording.columns import signal_of
from exo_sim.recording.table import Recording
from exo_sim.report.amounts import shown_in

#: Panels and samples a line that a figure has at most.
_MOST_PANELS, _MOST_SAMPLES = 12, 20_000
_STYLES = ("-", "--", ":")
#: What the parts of the person are called.
_WEARER = "wearer_"


def panels(recordings: Sequence[tuple[str, Recording]], signals: Sequence[str] | None = None) -> Picture:
    """Draw recordings of one machine over each other.

    Args:
        recordings: Label and recording; the first says what is drawn. Labels tell the lines of one signal apart.
        signals: Keys ("piston.pressure_1") or kinds ("pressure_1"); everything measured when None.

    Raises:
        RecordingError: a signal is not there.
    """
    first = recordings[0][1]
    groups: dict[tuple[str, str, bool], list[str]] = {}  # the wearer's joints apart from the machine's: each panel has room for a legend
    for key in _chosen(first, signals):
        groups.setdefault((key.rsplit(".", 1)[1], first.units[key], key.startswith(_WEARER)), []).append(key)
    shown = list(groups.items())[:_MOST_PANELS]
    figure = Picture(figsize=(9.0, 1.0 + 1.7 * len(shown)), layout="constrained")
    axes = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for panel, ((_, unit, of_wearer), keys) in zip(axes, shown):
        largest = max((float(np.nanmax(np.abs(first[key]))) for key in keys if np.isfinite(first[key]).any()), default=1.0)
        name, size = shown_in(unit, largest)
        for i, key in enumerate(keys):
            for (label, recording), style in zip(recordings, _STYLES):
                if (values := recording.get(key)) is not None:
                    part = key.rsplit(".", 1)[0]
                    every = max(1, len(values) // _MOST_SAMPLES)
                    panel.plot(recording.time[::every], values[::every] / size, style, color=f"C{i % 10}", lw=1.0,
                               label=f"{part}, {label}" if label else part)  # fmt: skip
        panel.set_title(signal_of(keys[0]).label + (", wearer" if of_wearer else ""), loc="left", fontsize=9)
        panel.set_ylabel(name)
        if len(keys) * len(recordings) <= 12:
            panel.legend(fontsize=7, loc="upper right", ncols=min(4, len(keys) * len(recordings)))
    axes[-1].set_xlabel("time [s]")
    return figure


def _chosen(recording: Recording, signals: Sequence[str] | None) -> list[str]:
    if signals is None:
        measured = [key for key in recording.columns if signal_of(key).measured]
        return measured or list(recording.columns)
    wanted = [signals] if isinstance(signals, str) else list(signals)
    chosen = []
    for name in wanted:
        found = [key for key in recording.columns if name in (key, key.rsplit(".", 1)[1])]
        if not found:
            raise RecordingError(f'no signal "{name}" was recorded{nearest(name, recording.columns)}')
        chosen += found
    return list(dict.fromkeys(chosen))
