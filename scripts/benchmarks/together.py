"""Two recordings of one machine: seconds on one core and on two, and whether the answer is the same."""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks import recordings
from benchmarks.diagnose import cores, timed
from benchmarks.figure import Asked, Figure, Said
from exo_sim.cli.printing import json_text


def measure(asked: Asked) -> Said:
    """Measure 12 s each, with one and with two threads; both take turns, the quicker of two counts."""
    with tempfile.TemporaryDirectory() as name:
        written = recordings.write(Path(name), "wall_heat_transfer", [12.0, 12.0], together=True)
        files, rig = [path for path, _ in written], written[0][1]
        timed(files, rig)  # compiles
        taken, answers = {1: float("inf"), 2: float("inf")}, set()
        for _ in range(2):
            for jobs in taken:
                seconds, found = timed(files, rig, jobs)
                taken[jobs] = min(taken[jobs], seconds)
                answers.add(json_text(found.as_dict()))
        busy = cores(files, rig)
    return [
        Figure("two_recordings_1_s", "diagnose 2 x 12 s, one thread", taken[1], "{:.1f} s"),
        Figure("two_recordings_2_s", "diagnose 2 x 12 s, two threads", taken[2], "{:.1f} s"),
        Figure("two_threads_ratio", "two threads against one", taken[1] / taken[2], "{:.2f} times", above=1.0),
        Figure("cores_in_use", "cores in use with two threads", busy, "{:.2f}"),
        Figure("different_answers", "different answers of four", len(answers), "{:.0f}", below=2.0),
    ]
