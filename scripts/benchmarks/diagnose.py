"""Seconds of a diagnosis with all candidates, on two cores, compiled before; and how they grow with the length."""

from __future__ import annotations

import tempfile
import time
from itertools import pairwise
from pathlib import Path

from benchmarks import recordings
from benchmarks.figure import Asked, Figure, Said
from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.diagnosis.result import Diagnosis

#: One of the gas, one whose answer is in jerks, one of the motion.
CONCEALED = ("wall_heat_transfer", "valve_deadband", "viscous_friction")
LENGTHS = (6.0, 12.0, 24.0, 48.0)
#: Growth by this factor a doubling would be no longer linear.
LINEAR = 2.3


def timed(files: list[Path], rig: Path, jobs: int = 2) -> tuple[float, Diagnosis]:
    """Return the seconds of one diagnosis, and what it found."""
    begun = time.perf_counter()
    found = diagnose(files, rig, jobs=jobs, folder=rig.parent)
    return time.perf_counter() - begun, found


def cores(files: list[Path], rig: Path, jobs: int = 2) -> float:
    """Return how many cores one diagnosis keeps busy on the average."""
    begun = time.process_time()
    taken, _ = timed(files, rig, jobs)
    return (time.process_time() - begun) / taken


def measure(asked: Asked) -> Said:
    """Measure 24 s at 1 kHz with one of three things concealed, and 6 to 48 s of the first; the quicker of two counts."""
    said: list[Figure | str] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        beginnings = recordings.write(folder, CONCEALED[0], LENGTHS)
        timed([beginnings[0][0]], beginnings[0][1])  # compiles
        taken = dict.fromkeys(LENGTHS, float("inf"))
        for _ in range(2):
            for length, (path, rig) in zip(LENGTHS, beginnings, strict=True):
                taken[length] = min(taken[length], timed([path], rig)[0])
        for effect in CONCEALED:
            ((path, rig),) = recordings.write(folder, effect, [24.0])
            tries = [timed([path], rig) for _ in range(2)]
            said += _row(effect, min(seconds for seconds, _ in tries), tries[0][1])
        said.append(Figure("diagnose_cores", "cores in use meanwhile", cores([path], rig)))
    for length, seconds in taken.items():
        said.append(Figure(f"diagnose_{length:g}_s_s", f"diagnose, first {length:g} s of 48 s", seconds, "{:.1f} s"))
    for short, long in pairwise(LENGTHS):
        label = f"{long:g} s against {short:g} s"
        said.append(Figure(f"diagnose_growth_{long:g}", label, taken[long] / taken[short], "{:.2f} times", below=LINEAR))
    return said


def _row(effect: str, seconds: float, found: Diagnosis) -> Said:
    row: list[Figure | str] = [Figure(f"diagnose_{effect}_s", f"diagnose 24 s, {effect}", seconds, "{:.1f} s", below=10.0)]
    named = [finding.name for finding in found.effects if finding.kind != "calibration"]
    if named != [effect]:
        row.append(f"diagnose 24 s, {effect}: named {', '.join(named) or 'nothing'} instead")
    return row
