"""Commands of a valve that the rig does not have, or has of another kind: what they did has no place in the model, and would look like
physics without a name."""

from __future__ import annotations

import numpy as np

from exo_sim.conventions.check import Check, named
from exo_sim.conventions.commands import never_opens
from exo_sim.conventions.machine import Machine
from exo_sim.recording.table import Recording
from exo_sim.signals import VALVE_COMMANDS


def without_one(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Return the recording as it is, and a question for each cylinder without a valve of which a command was recorded that moves."""
    checks = []
    for name, cylinder in machine.rig.cylinders.items():
        key = f"{name}.valve_command"
        if cylinder.valve_area > 0.0 or not _moves(recording, key):
            continue
        says = (
            f'"{key}": the rig has no valve at {name}, so that nothing follows this command; write [cylinders.{name}.valve] with its area, '
            'as area = "10 mm^2"'
        )
        checks.append(Check("valve", (key,), says))
    return recording, checks


def of_another_kind(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Return the recording as it is, and a question for each valve of which only commands were recorded that its kind does not take."""
    checks = []
    for name, cylinder in machine.rig.cylinders.items():
        if cylinder.valve_area <= 0.0 or any(f"{name}.{command}" in recording for command in cylinder.commands):
            continue
        keys = tuple(key for command in VALVE_COMMANDS if _moves(recording, key := f"{name}.{command}"))
        if not keys:
            continue
        if cylinder.valve.independent:
            what, kind, other = "a valve with independent edges, which takes valve_command_1 and valve_command_2", "4-way", "record both"
        else:
            what, kind, other = "a 4-way valve, which takes valve_command alone", "independent", "name its column so"
        them = "it" if len(keys) == 1 else "them"
        says = f'{named(keys)}: nothing reads {them}, the rig has {what}; write kind = "{kind}" in [cylinders.{name}.valve], or {other}'
        checks.append(Check("valve kind", keys, says))
    return recording, checks


def _moves(recording: Recording, key: str) -> bool:
    values = recording.get(key)
    return values is not None and bool(np.isfinite(values).any()) and not never_opens(values)
