"""Errors of the whole machine, simulated: the improved rig, and the rig as handed in, in one run or over windows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.computed_columns import shown_noise, was_computed
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.sampled_commands import early_commands
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.policy.budgets import LEAD, LONGEST_FREE_RUN
from exo_sim.diagnosis.policy.recordings import FEWEST_TO_FIT
from exo_sim.diagnosis.validation.recorded_run import Machine, judged_part, run_of
from exo_sim.recording import noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.replay import WINDOW as REPLAY_WINDOW
from exo_sim.simulation.replay import Run

Array = NDArray[np.float64]
#: By window: number of samples and sums of squared errors before and after, shape (3,).
Blocks = dict[int, Array]

#: Windows of one recording are numbered by this times its place among the recordings, and their own.
MOST_BLOCKS = 1_000_000


class MachineRuns:
    """Runs of the rig as handed in and of any number of improved ones: motion and gas together, as whoever uses the rig runs it.

    Where the clock jumps a run begins anew. Where a joint was driven by forces that nobody measured, motion is imposed in both runs
    and only pressures are predicted. A valve command with the wrong sign is reversed, for a rig cannot say that.

    Args:
        data: The recordings, and the rig as handed in.
        split: Its test time counts.
        window: After so long the measured state is taken over [s]; never where infinite.
        part: Shares of the test time, from its beginning on, at which runs begin and end, 0 to 1; None for whole recordings.
    """

    def __init__(self, data: MachineData, split: Split, window: float = math.inf, part: tuple[float, float] | None = None) -> None:
        self._data, self._split, self._window = data, split, window
        self._tables = [judged_part(table, data) for table in data.as_read if table.name in split.test]
        if window < math.inf:
            around = [_around(table, split) for table in self._tables]
            self._tables = [table for table in around if len(table.time) > FEWEST_TO_FIT]
        if part is not None:
            cut = [_part_of(table, split, *part) for table in self._tables]
            self._tables = [table for table in cut if len(table.time) > FEWEST_TO_FIT and table.duration > REPLAY_WINDOW]
        cylinders = [run for runs in data.cylinders.values() for run in runs]
        self._early = [early_commands(table.name, data.rig, cylinders) for table in self._tables]
        self._nominal: dict[tuple[int, str], tuple[Recording, Run] | None] = {}
        self._improved: tuple[Machine, dict[int, tuple[Recording, Run] | None]] | None = None
        self._machine = Machine(data.rig)
        self._known: tuple[Rig, dict[str, Sums]] | None = None

    def over(self, split: Split) -> MachineRuns:
        """Return the same runs free of windows, judged on another time of the same recordings: what was run last is not run again."""
        assert self._window == math.inf
        other = copy(self)
        other._split, other._known = split, None
        return other

    def errors(self, improved: Rig) -> dict[str, SignalFit]:
        """Return, by column, the errors on the test time; empty where something would have to be assumed, or the recordings are long.

        What the rig as handed in predicts and the improved one cannot has no error after that is a number.

        Raises:
            RigError, ModelError: the improved rig cannot be a machine.
        """
        return {key: sums.result() for key, sums in self._sums(improved).items()}

    def by_block(self, improved: Rig) -> dict[str, Blocks]:
        """Return, by column, the squared errors of every window of the test time; arguments as `errors`."""
        return {key: sums.blocks for key, sums in self._sums(improved).items()}

    def _sums(self, improved: Rig) -> dict[str, Sums]:
        if self._known and self._known[0] is improved:
            return self._known[1]
        total: dict[str, Sums] = {}
        if sum(table.duration for table in self._tables) > LONGEST_FREE_RUN:
            return total
        if self._improved is None or self._improved[0].rig is not improved:
            self._improved = Machine(improved), {}
        for number, table in enumerate(self._tables):
            self._add(total, number, self._split.in_test(table.name, table.time))
        self._known = improved, {key: sums for key, sums in total.items() if sums.count}
        return self._known[1]

    def _before(self, number: int, motion: str) -> tuple[Recording, Run] | None:
        """Return a recording as the rig handed in sees it, and its run; None where something that it depends on was not recorded."""
        if (number, motion) not in self._nominal:
            self._nominal[number, motion] = run_of(self._tables[number], self._machine, motion, self._window, self._early[number])
        return self._nominal[number, motion]

    def _after(self, number: int) -> tuple[Recording, Run] | None:
        """Return the same for the improved rig."""
        assert self._improved is not None
        machine, ran = self._improved
        if number not in ran:
            ran[number] = run_of(self._tables[number], machine, "auto", self._window, self._early[number])
        return ran[number]

    def _add(self, total: dict[str, Sums], number: int, mask: NDArray[np.bool_]) -> None:
        """Add the errors of one recording, whose samples `mask` count."""
        table, ran = self._tables[number], self._after(number)
        if ran is None:
            if (alone := self._before(number, "auto")) is None:
                return
            ran = alone[0], _lost(alone[1])
        recorded, after = ran
        nominal = self._before(number, "recorded" if after.imposed else "predicted")
        if nominal is None:
            return
        before = nominal[1]
        mask, computed = mask & after.simulated, was_computed(recorded)
        for key in (key for key in after.predicted.columns if key in before.predicted):
            there = mask & np.isfinite(recorded[key])
            if there.any():
                sums = total.setdefault(key, Sums(table.units[key]))
                block = number * MOST_BLOCKS + np.floor(table.time[there] / REPLAY_WINDOW).astype(np.int64)
                sums.add(recorded[key][there], [one.predicted[key][there] for one in (before, after)], block)
                floor = noise.floor(recorded[key], recorded.time).std
                sums.noise = max(sums.noise, shown_noise(floor, recorded[key], computed))


class Sums:
    """Squared errors of one column before and after, summed over any number of recordings."""

    def __init__(self, unit: str) -> None:
        self.unit, self.noise = unit, 0.0
        self.blocks: Blocks = {}

    @property
    def count(self) -> int:
        """Number of samples."""
        return int(sum(block[0] for block in self.blocks.values()))

    def add(self, recorded: Array, runs: Sequence[Array], block: NDArray[np.int64]) -> None:
        """Count errors of shape (n,) before and after, each in its block; a sum is not finite where a simulation diverged."""
        with np.errstate(over="ignore", invalid="ignore"):
            numbers, at = np.unique(block, return_inverse=True)
            squares = (np.ones(len(recorded)), *((run - recorded) ** 2 for run in runs))
            sums = np.stack([np.bincount(at, weights=one) for one in squares], axis=1)
        for number, own in zip(numbers.tolist(), sums, strict=True):
            self.blocks[number] = self.blocks.get(number, np.zeros(3)) + own

    def result(self) -> SignalFit:
        """Return the root mean square errors."""
        with np.errstate(over="ignore", invalid="ignore"):
            count, *squares = np.sum(list(self.blocks.values()), axis=0)
        before, after = np.sqrt(np.where(np.isfinite(squares), squares, math.nan) / count)
        return SignalFit(self.unit, float(before), float(after), self.noise)


def _around(table: Recording, split: Split) -> Recording:
    """Return the part of a recording that its test time needs: from a lead before it on, in which the gas comes to its temperature."""
    spans = split.test[table.name]
    return table.span(min(start for start, _ in spans) - LEAD, np.nextafter(max(stop for _, stop in spans), math.inf))


def _part_of(table: Recording, split: Split, begin: float, end: float) -> Recording:
    """Return the part of a recording from one share of its test time to another."""
    spans = split.test[table.name]
    start, stop = min(start for start, _ in spans), max(stop for _, stop in spans)
    return table.span(start + begin * (stop - start), np.nextafter(start + end * (stop - start), math.inf))


def _lost(ran: Run) -> Run:
    """Return a run that predicts no number."""
    columns = {key: np.full_like(values, math.nan) for key, values in ran.predicted.columns.items()}
    return replace(ran, predicted=replace(ran.predicted, columns=columns))

