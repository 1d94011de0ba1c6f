"""`exo.inspect`: what is in a recording, and what looks wrong."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, replace
from typing import Any

from exo_sim.api.arguments import Columns, RecordingLike, RigLike, reading_of, rig_of
from exo_sim.conventions.answerable import Question, questions
from exo_sim.recording import summary, summary_text
from exo_sim.recording.data_quality_finding import Finding


@dataclass(frozen=True, repr=False)
class Inspection:
    """What is in a recording.

    Attributes:
        found: All of it, in numbers.
        summary: What `exo-sim inspect --json` prints.
        questions: Every effect at every place of the machine, and what the recording lacks to answer it; empty without a rig.
    """

    found: summary.Summary
    summary: dict[str, Any]
    questions: tuple[Question, ...] = ()

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Return what looks wrong, the gravest first."""
        return self.found.findings

    def text(self, every_column: bool = False) -> str:
        """Return what `exo-sim inspect` prints.

        Args:
            every_column: The numbers of every column, as with `--all`; else, of a recording with many, of those to look at.
        """
        return summary_text.text(self.found, every_column) + (f"\n\n{self._asked()}" if self.questions else "")

    def __str__(self) -> str:
        return self.text()

    def _asked(self) -> str:
        """Return which questions can be asked, by place, and what the others lack."""
        asked: dict[str, list[str]] = {}
        lacking: dict[str, dict[str, None]] = {}
        for one in self.questions:
            if one.answerable:
                asked.setdefault(one.where, []).append(one.effect)
            for reason in one.missing:
                lacking.setdefault(reason, {})[one.effect] = None
        lines = ["Questions that a diagnosis of this recording can ask"]
        lines += [textwrap.fill(f"  {place}: {', '.join(names)}", 110, subsequent_indent="    ") for place, names in asked.items()]
        if not asked:
            lines.append("  none")
        if lacking:
            lines.append("What is missing for others")
            lines += [textwrap.fill(f"  {why}: for {', '.join(names)}", 110, subsequent_indent="    ") for why, names in lacking.items()]
        return "\n".join(lines)

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
    from exo_sim.conventions.belonging import of_another_machine
    from exo_sim.conventions.filling import slow_for_gas
    from exo_sim.machine.rig_model import load
    from exo_sim.recording.health import Facts
    from exo_sim.rig.limits import passed, reached_in

    machine = rig_of(rig)
    model = load(machine)
    settled = conventions.asked(reading.recording, machine, model)
    beyond = passed(machine, reached_in(machine, settled.recording.columns))
    limits = [Finding(next(iter(machine.cylinders)), "limit", words) for words in beyond]
    slow = slow_for_gas(settled.recording, machine)
    strange = of_another_machine(reading.recording, machine, model)
    other = [Finding(reading.recording.parts()[0], "another machine", strange, severity="fault")] if strange else []
    asked = (*other, *conventions.findings(settled), *reading.findings, *limits, *slow)
    found = summary.summarise(replace(reading, recording=settled.recording, findings=asked), Facts.of(machine, model))
    asked_of = () if strange else tuple(questions(settled.recording, machine, model))
    return Inspection(found, summary.as_dict(found) | {"questions": [one.as_dict() for one in asked_of]}, asked_of)
