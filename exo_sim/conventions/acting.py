"""A chamber that the rig leaves open to the atmosphere and that a recording shows under pressure."""

from __future__ import annotations

import numpy as np

from exo_sim.conventions import limits
from exo_sim.conventions.check import Check
from exo_sim.conventions.machine import Machine
from exo_sim.recording.table import Recording


def as_recorded(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Refuse a single-acting cylinder whose chamber 2 holds more than a vent leaves: as the rig has it, that pressure pushes nothing."""
    checks = []
    for name, cylinder in machine.rig.cylinders.items():
        key = f"{name}.pressure_2"
        values = recording.get(key)
        if not cylinder.single_acting or values is None or not np.isfinite(values).any():
            continue
        low, high = np.nanquantile(values, (0.05, 0.75))
        if high > (1.0 + limits.VENTED) * machine.atmosphere:
            says = (
                f'"{key}": it is {1e-5 * low:.3g} to {1e-5 * np.nanquantile(values, 0.95):.3g} bar, and cylinders.{name} of '
                f'{machine.rig.path} has acting = "single", whose chamber 2 is open to the atmosphere; set acting = "double" '
                "there, or leave the column out if it is another chamber's"
            )
            checks.append(Check("acting", (key,), says, refused=True))
    return recording, checks
