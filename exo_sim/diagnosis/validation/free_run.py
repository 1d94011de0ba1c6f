"""Errors of one free run: the improved rig, and the rig as handed in, simulated from the first measured state to the end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.command_sign import is_reversed_command
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.policy.budgets import LONGEST_FREE_RUN
from exo_sim.errors import ExoSimError
from exo_sim.machine.rig_model import load
from exo_sim.recording import noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig, parse
from exo_sim.simulation.replay import FreeRun, free_run, usable

Array = NDArray[np.float64]


class FreeRuns:
    """Runs that no measurement corrects on their way, of the rig as handed in and of any number of improved ones.

    Where the clock jumps a run begins anew. Where a joint was driven by forces that nobody measured, motion is imposed in both runs
    and only pressures are predicted. A valve command with the wrong sign is reversed, for a rig cannot say that.

    Args:
        data: The recordings, and the rig as handed in.
        split: Its test time counts.
    """

    def __init__(self, data: MachineData, split: Split) -> None:
        self._data, self._split = data, split
        self._tables = [judged_part(table, data) for table in data.as_read if table.name in split.test]
        self._believed: dict[tuple[int, str], tuple[Recording, FreeRun | None]] = {}
        self._machine: _Machine | None = None

    def errors(self, improved: str) -> dict[str, SignalFit]:
        """Return, by column, the errors on the test time; empty where something would have to be assumed, or the recordings are long.

        Args:
            improved: Text of the rig with what was found, as it would stand beside the rig.
        """
        if sum(table.duration for table in self._tables) > LONGEST_FREE_RUN:
            return {}
        total: dict[str, _Sums] = {}
        with suppress(ExoSimError):  # nothing that can be predicted: what is missing has been said already
            self._machine = self._machine or _Machine(self._data.rig)
            found = _Machine(parse(improved, self._data.rig.path))
            for number, table in enumerate(self._tables):
                with suppress(ExoSimError):
                    self._add(total, number, found, self._split.in_test(table.name, table.time))
        return {key: sums.result() for key, sums in total.items() if sums.count}

    def _add(self, total: dict[str, _Sums], number: int, improved: _Machine, mask: NDArray[np.bool_]) -> None:
        """Add the errors of one recording, whose samples `mask` count."""
        table = self._tables[number]
        recorded, after = _run(table, improved, "auto")
        if after is None or self._machine is None:
            return
        way = (number, "recorded" if after.imposed else "predicted")
        if way not in self._believed:
            self._believed[way] = _run(table, self._machine, way[1])
        before = self._believed[way][1]
        if before is None:
            return
        mask = mask & after.simulated
        for key in (key for key in after.predicted.columns if key in before.predicted):
            there = mask & np.isfinite(recorded[key])
            if there.any():
                sums = total.setdefault(key, _Sums(table.units[key]))
                sums.add(recorded[key][there], [run.predicted[key][there] for run in (before, after)])
                sums.noise = max(sums.noise, noise.floor(recorded[key], recorded.time).std)


class _Machine:
    """A rig with its model."""

    def __init__(self, rig: Rig) -> None:
        self.rig: Rig = rig
        self.model: mujoco.MjModel = load(rig)


def judged_part(table: Recording, data: MachineData) -> Recording:
    """Return a recording from where its gas is judged, its valve commands with the sign that they were found to have."""
    starts = [run.time[0] for runs in data.cylinders.values() for run in runs if run.recording == table.name]
    table = table.span(max(starts, default=-math.inf), math.inf)
    wrong = {finding.where for finding in data.sensors if is_reversed_command(finding)}
    return replace(table, columns={key: -values if key in wrong else values for key, values in table.columns.items()})


class _Sums:
    """Squared errors of one column before and after, summed over any number of recordings."""

    def __init__(self, unit: str) -> None:
        self.unit, self.count, self.squares, self.noise = unit, 0, np.zeros(2), 0.0

    def add(self, recorded: Array, runs: Sequence[Array]) -> None:
        """Count errors of shape (n,) before and after; the sum is not finite where a simulation diverged."""
        with np.errstate(over="ignore", invalid="ignore"):
            self.squares += [float(np.sum((run - recorded) ** 2)) for run in runs]
        self.count += len(recorded)

    def result(self) -> SignalFit:
        """Return the root mean square errors."""
        before, after = np.sqrt(np.where(np.isfinite(self.squares), self.squares, math.nan) / self.count)
        return SignalFit(self.unit, float(before), float(after), self.noise)


def _run(table: Recording, machine: _Machine, motion: str) -> tuple[Recording, FreeRun | None]:
    """Return what a rig's sensors let one believe of a recording, and its run."""
    recorded, _ = usable(table, machine.rig, machine.model)
    return recorded, free_run(recorded, machine.rig, machine.model, motion=motion)
