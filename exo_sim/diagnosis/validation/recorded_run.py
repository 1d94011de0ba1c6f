"""One recording run by one rig: motion and gas together, as whoever uses the rig runs it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import mujoco

from exo_sim.diagnosis.data.command_sign import is_reversed_command
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.errors import RecordingError
from exo_sim.machine.rig_model import load
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.replay import Run, run, usable


class Machine:
    """A rig with its model.

    Args:
        rig: The rig.

    Raises:
        RigError, ModelError: it cannot be a machine.
    """

    def __init__(self, rig: Rig) -> None:
        self.rig: Rig = rig
        self.model: mujoco.MjModel = load(rig)


def judged_part(table: Recording, data: MachineData) -> Recording:
    """Return a recording from where its gas is judged, its valve commands with the sign that they were found to have."""
    starts = [run.time[0] for runs in data.cylinders.values() for run in runs if run.recording == table.name]
    table = table.span(max(starts, default=-math.inf), math.inf)
    wrong = {finding.where for finding in data.sensors if is_reversed_command(finding)}
    return replace(table, columns={key: -values if key in wrong else values for key, values in table.columns.items()})


def run_of(
    table: Recording, machine: Machine, motion: str, window: float, early: Mapping[str, float]
) -> tuple[Recording, Run] | None:
    """Return what a rig's sensors let one believe of a recording, and its run; None where that cannot be run.

    Args:
        table: The recording, as `judged_part` leaves it.
        machine: The rig.
        motion, window, early: As of `simulation.replay.run`.
    """
    try:
        recorded, _ = usable(table, machine.rig, machine.model)
        found = run(recorded, machine.rig, machine.model, motion=motion, window=window, early=early)
    except RecordingError:  # nothing that can be predicted: what is missing has been said already
        return None
    return None if found is None else (recorded, found)
