"""A machine that nobody wears follows a recorded motion: the part of `exo.simulate` that knows no wearer."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from exo_sim.api.arguments import Columns, reading_of
from exo_sim.api.moment import Moment
from exo_sim.api.recording import Recording
from exo_sim.api.rig import Rig
from exo_sim.api.simulated import Run, summary_of, target_of, times_of
from exo_sim.errors import RecordingError, ScenarioError
from exo_sim.outputs import check_writable
from exo_sim.recording import table as table_of

#: Endings of recordings that a machine can follow.
MOTIONS = (".csv", ".tsv", ".txt", ".parquet", ".pq", ".rrd")

#: What says how somebody walks, as it stands where nobody asked for anything.
_AS_EVER = {
    "gait": None, "ground": None, "whole": False, "payload": None, "speed": 1.0, "strides": None, "assist": "on", "demand": "least_load",
    "wearer": None, "signals": "exact",
}  # fmt: skip


def is_motion(scenario: object) -> bool:
    """Return whether it is a recording, or a path that ends like one."""
    if isinstance(scenario, table_of.Recording):
        return True
    return isinstance(scenario, str | os.PathLike) and Path(scenario).suffix.lower() in MOTIONS


def nobody_walks(rig: Rig, **given: object) -> None:
    """Refuse what says how somebody walks where a machine that nobody wears follows a motion."""
    for name, value in given.items():
        if str(value) != str(_AS_EVER[name]):
            raise ScenarioError(f"--{name} says how somebody walks, and nobody wears {rig.name}, which follows a motion: leave it out")


def follow(
    rig: Rig, motion: str | os.PathLike[str] | Recording, controller: Any, called: str, out: str | os.PathLike[str] | bool, seed: int,
    quiet: bool, tell: Callable[[str], None], columns: Columns,
) -> Run:  # fmt: skip
    """Let a machine that nobody wears follow a motion."""
    from exo_sim.simulation import unworn_record
    from exo_sim.simulation.streamed_run import interrupts_noted
    from exo_sim.simulation.unworn import UnwornSimulation

    target = target_of(out, f"{motion.name if isinstance(motion, table_of.Recording) else Path(motion).stem}_{rig.name}")
    if target is not None:
        source = None if isinstance(motion, table_of.Recording) else Path(motion)
        if source and source.exists() and any(p.exists() and p.samefile(source) for p in (target, target.with_suffix(".parquet"))):
            raise RecordingError(f'"{source}" would be overwritten by the run; name another file with --out')
        check_writable(target.parent)
    begun = Moment.now()
    reading = reading_of(motion, columns)
    for finding in reading.findings:
        if finding.severity != "info":
            tell(finding.says)
    simulation = UnwornSimulation(rig, reading.recording, controller, called, seed)
    prepared = Moment.now()
    with interrupts_noted() as asked_to_stop:
        done = simulation.run(quiet, asked_to_stop)
    for words in simulation.remarks:
        tell(words)
    summary = summary_of(unworn_record.summarise(done), begun, prepared, simulation.remarks)
    name = reading.recording.name if target is None else target.stem
    run = Run(rig, name, summary, simulation.remarks, target, done.interrupted or asked_to_stop(), done, seed)
    if target is not None:
        run.save(target)
        run.summary.update(times_of(begun, prepared))
    return run
