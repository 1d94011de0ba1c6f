"""`exo.inspect`: what is in a recording, and what looks wrong."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from exo_sim.api.arguments import Columns, RecordingLike, RigLike, reading_of, rig_of
from exo_sim.recording import summary, summary_text
from exo_sim.recording.finding import Finding


@dataclass(frozen=True, repr=False)
class Inspection:
    """What is in a recording.

    Attributes:
        found: All of it, in numbers.
        summary: What `exo-sim inspect --json` prints.
    """

    found: summary.Summary
    summary: dict[str, Any]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Return what looks wrong, the gravest first."""
        return self.found.findings

    def __str__(self) -> str:
        return summary_text.text(self.found)

    def __repr__(self) -> str:
        return f"<exo.Inspection of {self.summary.get('name', 'a recording')}: {len(self.findings)} findings>"


def inspect(recording: RecordingLike, rig: RigLike | None = None, *, columns: Columns = None) -> Inspection:
    """Look a recording through: signals, gait events, pressures, torques, gas used, and what looks wrong.

    Args:
        recording: A path or `exo.Recording`.
        rig: A path or `exo.Rig` of the machine: more can then be found wrong.
        columns: Foreign names: a column map (TOML) or a dictionary.

    Raises:
        RecordingError, RigError, ModelError: unusable input; one line each.
    """
    reading = reading_of(recording, columns)
    if rig is None:
        found = summary.summarise(reading)
        return Inspection(found, summary.as_dict(found))
    from exo_sim import conventions
    from exo_sim.machine.load import load
    from exo_sim.recording.health import Facts

    machine = rig_of(rig)
    model = load(machine)
    settled = conventions.asked(reading.recording, machine, model)
    asked = (*conventions.findings(settled), *reading.findings)
    found = summary.summarise(replace(reading, recording=settled.recording, findings=asked), Facts.of(machine, model))
    return Inspection(found, summary.as_dict(found))
