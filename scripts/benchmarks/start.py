"""How long the command line takes to start."""

from __future__ import annotations

import tempfile

from benchmarks.command import seconds
from benchmarks.figure import Asked, Figure, Said


def measure(asked: Asked) -> Said:
    """Measure `--help` and a short run from start to end; with `--cold` also from an empty cache."""
    found = [Figure("help_s", "exo-sim --help", min(seconds(["--help"])[0] for _ in range(5)), "{:.2f} s", below=0.5)]
    with tempfile.TemporaryDirectory() as folder:
        short = ["run", "stand", "--strides", "1", "--assist", "vented", "--json", "--out", f"{folder}/stand.rrd"]
        found.append(Figure("start_cached_s", "start, cached", min(seconds(short)[0] for _ in range(3)), "{:.2f} s"))
        if asked.cold:
            cold = seconds(short, EXO_SIM_CACHE=f"{folder}/cache")[0]
            found.append(Figure("start_cold_s", "start, empty cache", cold, "{:.2f} s"))
    return found
