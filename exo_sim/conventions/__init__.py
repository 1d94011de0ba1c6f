"""In which conventions a recording was evidently written: units, zeros, signs and order of its columns, held against the rig.

Asked before any physics. What is known beyond doubt is put right and said; what cannot be computed at all is refused and says what to
correct. A healthy recording, and one of a machine that leaks, rubs or sticks, passes without a word.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco

from exo_sim.conventions import acting, commands, joint_units, missing_valves, positions, pressures, signs, unknown_parts
from exo_sim.conventions.check import Check
from exo_sim.conventions.machine import Machine
from exo_sim.errors import RecordingError
from exo_sim.recording.data_quality_finding import Finding, Use
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

#: Checks after which a column is not used.
_GONE = ("part", "command", "valve", "valve kind")

__all__ = ["Check", "Settled", "findings", "settle"]


@dataclass(frozen=True)
class Settled:
    """A recording as it was evidently meant.

    Attributes:
        recording: With what was put right.
        checks: What was asked, put right or refused, in the order in which it was.
    """

    recording: Recording
    checks: tuple[Check, ...]


def settle(recording: Recording, rig: Rig, model: mujoco.MjModel, noticed: Sequence[Finding] = ()) -> Settled:
    """Hold a recording's conventions against its rig.

    Args:
        recording: As it was read.
        rig: The machine.
        model: Its model.
        noticed: What was odd about its file.

    Raises:
        RecordingError: nothing sensible can be computed; the line says what to correct.
        ModelError: the model lacks a part of the rig.
    """
    settled = asked(recording, rig, model)
    for check in settled.checks:
        if check.refused:
            raise RecordingError(f'"{recording.name}": {check.says}')
    return replace(settled, checks=(*unknown_parts.misspelt(noticed, recording, Machine.of(rig, model)), *settled.checks))


def asked(recording: Recording, rig: Rig, model: mujoco.MjModel) -> Settled:
    """As `settle`, but refuses nothing: for those who want to hear all that is wrong."""
    machine, checks = Machine.of(rig, model), []
    steps = (
        unknown_parts.known, missing_valves.without_one, missing_valves.of_another_kind, joint_units.of_their_kind,
        pressures.in_pascal, pressures.absolute, acting.as_recorded, positions.in_place, signs.in_order, commands.that_open,
        commands.in_time,
    )  # fmt: skip
    for step in steps:
        recording, found = step(recording, machine)
        checks += found
        if any(check.refused for check in found):
            break
    return Settled(recording, tuple(checks))


def _use(check: Check) -> Use:
    return "set aside" if check.what in _GONE else "used" if check.left else "repaired"


def findings(settled: Settled) -> list[Finding]:
    """Return checks as what `inspect` lists."""
    return [
        Finding(check.columns[0], check.what, check.says, severity="fault", use="used")
        if check.refused
        else Finding(check.columns[0], check.what, check.says, severity="warning", use=_use(check))
        for check in settled.checks
    ]
