"""Columns that nothing reads, of a part or signal that is misspelt, where the machine lacks the column that was meant."""

from __future__ import annotations

from collections.abc import Sequence

from exo_sim.conventions.check import Check
from exo_sim.conventions.machine import Machine
from exo_sim.errors import near
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.table import Recording

#: Signals of a joint, of a cylinder and of the supply that a diagnosis misses.
_OF_JOINT, _OF_CYLINDER, _OF_SUPPLY = ("position",), ("pressure_1", "pressure_2", "valve_command"), "supply.pressure"


def known(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Return the recording as it is, and a question where a part is misspelt, or a cylinder stands in place of its joint."""
    joints = _joints(machine)
    joint_of = {link.cylinder: link.joint for link in machine.links}
    checks = []
    for key in recording.columns:
        part, _, signal = key.rpartition(".")
        kind, own = ("joint", joints) if signal in _OF_JOINT else ("cylinder", list(machine.rig.cylinders))
        if signal not in (*_OF_JOINT, *_OF_CYLINDER) or part in own:
            continue
        lacking = [name for name in own if f"{name}.{signal}" not in recording]
        meant = joint_of.get(part, "") if kind == "joint" else next((c for c, joint in joint_of.items() if joint == part), "")
        if likely := [meant] if meant in lacking else near(part, lacking):
            hint = " or ".join(f'"{name}"' for name in likely)
            says = f'"{key}": nothing reads it, the machine has no {kind} "{part}"; did you mean {hint}?'
            checks.append(Check("part", (key,), says, meant=f"{likely[0]}.{signal}"))
    return recording, checks


def misspelt(set_aside: Sequence[Finding], recording: Recording, machine: Machine) -> list[Check]:
    """Return a question for each column that was set aside because no signal is called so, and that is nearly one the machine lacks.

    Args:
        set_aside: What was found on reading.
        recording: What was read.
        machine: The machine.
    """
    wanted = [f"{joint}.{signal}" for joint in _joints(machine) for signal in _OF_JOINT]
    wanted += [f"{cylinder}.{signal}" for cylinder in machine.rig.cylinders for signal in _OF_CYLINDER]
    lacking = [key for key in (*wanted, _OF_SUPPLY) if key not in recording]
    checks = []
    for finding in set_aside:
        name = finding.column.partition("[")[0].strip()
        if finding.kind == "unknown column" and (likely := near(name, lacking)):
            checks.append(Check("column", (name,), finding.says, meant=likely[0]))
    return checks


def _joints(machine: Machine) -> list[str]:
    return [machine.model.joint(j).name for j in range(machine.model.njnt)]
