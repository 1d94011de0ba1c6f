"""Simulated seconds a second of `exo-sim run`."""

from __future__ import annotations

import json
import tempfile

from benchmarks.command import seconds
from benchmarks.figure import Asked, Figure, Said


def measure(asked: Asked) -> Said:
    """Measure ten strides of the loaded walk, both files written, on one core."""
    with tempfile.TemporaryDirectory() as folder:
        walk = ["run", "level_walk", "--payload", "34 kg", "--strides", "10", "--json", "--out", f"{folder}/walk.rrd"]
        results = [json.loads(seconds(walk)[1]) for _ in range(3)]
    best = max(result["simulated_s"] / result["wall_s"] for result in results)
    return [Figure("run_times_real_time", "run, both files, one core", best, "{:.1f} times real time")]
