"""Errors of the whole machine over windows of the training time, sample by sample: what numbers of a rig can be fitted to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.sampled_commands import early_commands
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.policy.budgets import BLOCKS, LEAD, LONGEST_MACHINE_FIT, MACHINE_ROW, MACHINE_WINDOW
from exo_sim.diagnosis.policy.recordings import FEWEST_TO_FIT
from exo_sim.diagnosis.validation.recorded_run import Machine, judged_part, run_of
from exo_sim.recording import noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.replay import run

Array = NDArray[np.float64]
#: By column, errors in units of its noise, shape (n,).
Errors = dict[str, Array]


@dataclass(frozen=True)
class _Stretch:
    """A recording, or a block of a long one.

    Attributes:
        recorded: What the sensors of the rig let one believe.
        early: As of `simulation.replay.run`.
        counted: By column, the samples that count, shape (n,).
        noise: By column, its standard deviation.
    """

    recorded: Recording
    early: Mapping[str, float]
    counted: Mapping[str, NDArray[np.bool_]]
    noise: Mapping[str, float]


class TrainingRuns:
    """Runs of any number of rigs over the training time, motion and gas together, begun anew at measured states.

    Of long recordings evenly spread blocks stand for all. Recordings whose motion has to be imposed, or with which something has to be
    assumed, are not run: their pressures were fitted already.

    Args:
        data: The recordings.
        split: What is not its training time does not count.
        rig: A rig with the sensors of all that will be run.

    Raises:
        RigError, ModelError: it cannot be a machine.
    """

    def __init__(self, data: MachineData, split: Split, rig: Rig) -> None:
        machine = Machine(rig)
        cylinders = [each for runs in data.cylinders.values() for each in runs]
        self._stretches: list[_Stretch] = []
        for table, first in _tables(data):
            early = early_commands(table.name, data.rig, cylinders)
            ran = run_of(table, machine, "auto", MACHINE_WINDOW, early)
            if ran is not None and not ran[1].imposed:
                recorded, here = ran[0], _rows(table.time, first) & split.in_training(table.name, table.time) & ran[1].simulated
                counted = {key: here & np.isfinite(recorded[key]) for key in ran[1].predicted.columns}
                counted = {key: rows for key, rows in counted.items() if rows.any()}
                floors = {key: max(noise.floor(recorded[key], recorded.time).std, 1e-300) for key in counted}
                self._stretches.append(_Stretch(recorded, early, counted, floors))

    @property
    def is_empty(self) -> bool:
        """Whether nothing can be run."""
        return not any(stretch.counted for stretch in self._stretches)

    def errors(self, rig: Rig) -> Errors | None:
        """Return the errors of a rig; None where a run leaves all bounds.

        Raises:
            RigError, ModelError: the rig cannot be a machine.
        """
        machine = Machine(rig)
        found: dict[str, list[Array]] = {}
        for one in self._stretches:
            ran = run(one.recorded, rig, machine.model, motion="predicted", window=MACHINE_WINDOW, early=one.early)
            if ran is None:
                return None
            for key, rows in one.counted.items():
                own = (ran.predicted[key][rows] - one.recorded[key][rows]) / one.noise[key]
                found.setdefault(key, []).append(own)
        whole = {key: np.concatenate(parts) for key, parts in found.items()}
        return whole if all(np.isfinite(own).all() for own in whole.values()) else None

    def independent(self, errors: Errors) -> dict[str, float]:
        """Return, by column, for how many independent samples its errors count."""
        blocks: dict[str, list[NDArray[np.int64]]] = {}
        for number, one in enumerate(self._stretches):
            window = np.floor(one.recorded.time / MACHINE_WINDOW).astype(np.int64)
            for key, rows in one.counted.items():
                blocks.setdefault(key, []).append((number << 32) + window[rows])
        return {key: len(own) / correlation_time(own, np.concatenate(blocks[key])) for key, own in errors.items()}


def _tables(data: MachineData) -> Iterator[tuple[Recording, float]]:
    """Yield the recordings, or blocks of long ones, each with the time from which on it counts [s]."""
    tables = [judged_part(table, data) for table in data.as_read]
    share = LONGEST_MACHINE_FIT / max(sum(table.duration for table in tables), 1e-9)
    for table in (table for table in tables if len(table.time) >= FEWEST_TO_FIT):
        start, length = float(table.time[0]), table.duration / BLOCKS
        if share >= 1.0:
            yield table, start
            continue
        for number in range(BLOCKS):
            begin = start + number * length
            block = table.span(begin, begin + min(LEAD + share * length, length))
            if len(block.time) >= FEWEST_TO_FIT:
                yield block, begin + LEAD


def _rows(time: Array, first: float) -> NDArray[np.bool_]:
    """Return the samples from `first` [s] on, thinned out to one every `MACHINE_ROW`, shape (n,)."""
    stride = max(round(MACHINE_ROW / float(np.median(np.diff(time)))), 1)
    return (time >= first) & (np.arange(len(time)) % stride == 0)
