"""One hour at 1 kHz: seconds and memory of `exo-sim diagnose`, files and page written."""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks import recordings
from benchmarks.command import seconds_and_peak
from benchmarks.figure import Asked, Figure, Said

HOUR = 3600.0


def measure(asked: Asked) -> Said:
    """Measure it, where asked for what takes many minutes."""
    if not asked.long:
        return ["one hour at 1 kHz: only with --long"]
    with tempfile.TemporaryDirectory() as name:
        ((path, rig),) = recordings.write(Path(name), "wall_heat_transfer", [HOUR])
        taken, peak = seconds_and_peak(["diagnose", str(path), "--rig", str(rig), "--out", f"{name}/found", "--quiet"], (0, 3, 4))
    return [
        Figure("hour_s", "diagnose, one hour", taken, "{:.0f} s", below=300.0),
        Figure("hour_gb", "memory, one hour", peak / 1e9, "{:.2f} GB", below=1.0),
    ]
