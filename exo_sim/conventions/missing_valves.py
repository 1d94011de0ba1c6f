"""Commands of a valve that the rig does not have: what they did has no place in the model, and would look like physics without a name."""

from __future__ import annotations

import numpy as np

from exo_sim.conventions.check import Check
from exo_sim.conventions.commands import never_opens
from exo_sim.conventions.machine import Machine
from exo_sim.recording.table import Recording


def without_one(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Return the recording as it is, and a question for each cylinder without a valve of which a command was recorded that moves."""
    checks = []
    for name, cylinder in machine.rig.cylinders.items():
        key = f"{name}.valve_command"
        values = recording.get(key)
        if cylinder.valve_area > 0.0 or values is None or not np.isfinite(values).any() or never_opens(values):
            continue
        says = (
            f'"{key}": the rig has no valve at {name}, so that nothing follows this command; write [cylinders.{name}.valve] with its area, '
            'as area = "10 mm^2"'
        )
        checks.append(Check("valve", (key,), says))
    return recording, checks
