"""Columns of a part that the machine does not have, where a part of its own lacks that column."""

from __future__ import annotations

from exo_sim.conventions.check import Check
from exo_sim.conventions.machine import Machine
from exo_sim.errors import nearest
from exo_sim.recording.table import Recording

#: Signals of a joint and of a cylinder that no diagnosis can do without.
_OF_JOINT, _OF_CYLINDER = ("position",), ("pressure_1", "pressure_2", "valve_command")


def known(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Return the recording as it is, and a question where a part is misspelt, or a cylinder stands in place of its joint."""
    joints = [machine.model.joint(j).name for j in range(machine.model.njnt)]
    joint_of = {link.cylinder: link.joint for link in machine.links}
    checks = []
    for key in recording.columns:
        part, _, signal = key.rpartition(".")
        kind, own = ("joint", joints) if signal in _OF_JOINT else ("cylinder", list(machine.rig.cylinders))
        if signal not in (*_OF_JOINT, *_OF_CYLINDER) or part in own:
            continue
        lacking = [name for name in own if f"{name}.{signal}" not in recording]
        if not lacking:
            continue
        meant = joint_of.get(part, "") if kind == "joint" else next((c for c, joint in joint_of.items() if joint == part), "")
        hint = f'; did you mean "{meant}"?' if meant in lacking else nearest(part, lacking)
        if "did you mean" in hint:
            checks.append(Check("part", (key,), f'"{key}": nothing reads it, the machine has no {kind} "{part}"{hint}'))
    return recording, checks
