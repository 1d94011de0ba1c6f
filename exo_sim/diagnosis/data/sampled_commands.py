"""Commands that are samples of a control loop quicker than the logger, and not what the valve got until the next sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.policy.recordings import CLOCK_ERROR, CONTROL_PERIOD
from exo_sim.rig import Rig


def may_be_sampled(run: CylinderRun) -> bool:
    """Return whether a recording is so slow that its commands may be samples of others between them."""
    return run.commanded and not run.at_rest and float(np.median(np.diff(run.time))) > CONTROL_PERIOD * (1.0 + CLOCK_ERROR)


def remark(run: CylinderRun, commands: Sequence[str]) -> str:
    """Return what to say of commands that are samples."""
    period = 1e3 * float(np.median(np.diff(run.time)))
    keys = ", ".join(f'"{run.cylinder}.{command}"' for command in commands)
    return (
        f"{run.recording}: {keys}: pressures follow the mean of two samples better than each held until the next, so a loop quicker than "
        f"the logger's {period:.3g} ms made them; what happened between samples counts as an error of the prediction"
    )


def early_commands(recording: str, rig: Rig, runs: Sequence[CylinderRun]) -> dict[str, float]:
    """Return by column how long before each sample a command is held [s], where commands are samples: half a period.

    The command between two samples is then about their mean, as the gas is predicted (`GasInputs.command_after`).

    Args:
        recording: Name of a recording.
        rig: The machine.
        runs: Of its cylinders.
    """
    sampled = [run for run in runs if run.sampled and run.recording == recording]
    return {
        f"{run.cylinder}.{command}": 0.5 * float(np.median(np.diff(run.time)))
        for run in sampled
        for command in rig.cylinders[run.cylinder].commands
    }
