"""Columns of a joint in units of the other kind: an angle under the name of a joint that slides, a length under that of one that turns."""

from __future__ import annotations

import mujoco

from exo_sim.conventions.check import Check
from exo_sim.conventions.machine import Machine
from exo_sim.recording.table import Recording

#: Signals of a joint with the units of one that slides and of one that turns.
_UNITS = {"position": ("m", "rad"), "velocity": ("m/s", "rad/s"), "external_force": ("N", "N*m")}
_KINDS = {int(mujoco.mjtJoint.mjJNT_SLIDE): 0, int(mujoco.mjtJoint.mjJNT_HINGE): 1}


def of_their_kind(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Return the recording as it is, and a refusal of every column whose unit is none of its joint's kind."""
    kinds = {machine.model.joint(j).name: _KINDS.get(int(machine.model.jnt_type[j])) for j in range(machine.model.njnt)}
    checks = []
    for key in recording.columns:
        joint, _, signal = key.rpartition(".")
        kind = kinds.get(joint)
        if kind is None or signal not in _UNITS:
            continue
        wanted, other = _UNITS[signal][kind], _UNITS[signal][1 - kind]
        if recording.units.get(key) == other:
            does = ("slides", "turns")[kind]
            says = (
                f'"{key}" is in a unit of "{other}", but the joint "{joint}" of {machine.rig.model.name} {does}: '
                f'write its heading like "{key} [{wanted}]"'
            )
            checks.append(Check("unit", (key,), says, refused=True))
    return recording, checks
