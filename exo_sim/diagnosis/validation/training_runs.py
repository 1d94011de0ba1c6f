"""Errors of the whole machine over windows of the training time, sample by sample: what numbers of a rig can be fitted to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.computed_columns import shown_noise, was_computed
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.sampled_commands import early_commands
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.policy.budgets import LEAD, LONGEST_MACHINE_FIT, MACHINE_BLOCK, MACHINE_ROW, MACHINE_WINDOW
from exo_sim.diagnosis.policy.recordings import FEWEST_TO_FIT
from exo_sim.diagnosis.validation.recorded_run import Machine, judged_part, run_of
from exo_sim.recording import noise
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.replay import Run, run

Array = NDArray[np.float64]
#: By column, errors in units of its noise, shape (n,).
Errors = dict[str, Array]
#: A recording with the first and the last moment of a part of it [s].
Span = tuple[Recording, float, float]


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


def _stretch(recorded: Recording, ran: Run, early: Mapping[str, float], rows: NDArray[np.bool_]) -> _Stretch:
    """Return the columns of a run that can be held against something: not those that never move and have no noise."""
    computed = was_computed(recorded)
    floors = {key: shown_noise(noise.floor(recorded[key], recorded.time).std, recorded[key], computed) for key in ran.predicted.columns}
    counted = {key: rows & ran.simulated & np.isfinite(recorded[key]) for key, floor in floors.items() if floor > 0.0}
    return _Stretch(recorded, early, {key: here for key, here in counted.items() if here.any()}, floors)


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
        for table, first in _parts(data, split):
            early = early_commands(table.name, data.rig, cylinders)
            ran = run_of(table, machine, "auto", MACHINE_WINDOW, early)
            if ran is not None and not ran[1].imposed:
                self._stretches.append(_stretch(ran[0], ran[1], early, _rows(table.time, first)))

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


def _parts(data: MachineData, split: Split) -> Iterator[tuple[Recording, float]]:
    """Yield the training time of the recordings, or blocks of it, each with the time from which on it counts [s].

    A run begins where the recording does, or a while before what counts, for its gas to come to its temperature.
    """
    spans = [span for table in data.as_read for span in _training_spans(judged_part(table, data), split)]
    total = sum(end - begin for _, begin, end in spans)
    for table, begin, end in spans if total <= LONGEST_MACHINE_FIT else _spread(spans, total):
        first = begin + (LEAD if begin > table.time[0] else 0.0)
        part = table.span(begin, float(np.nextafter(end, np.inf)))
        if len(part.time) >= FEWEST_TO_FIT and first < end:
            yield part, first


def _training_spans(table: Recording, split: Split) -> list[Span]:
    """Return the stretches of a recording that are training time."""
    inside = np.concatenate([[False], split.in_training(table.name, table.time), [False]])
    edges = np.flatnonzero(np.diff(inside))
    return [(table, float(table.time[a]), float(table.time[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _spread(spans: Sequence[Span], total: float) -> Iterator[Span]:
    """Yield blocks that are evenly spread over spans of so many seconds, and with their leads are no longer than may be run."""
    length = LEAD + MACHINE_BLOCK
    count = max(int(LONGEST_MACHINE_FIT / length), 1)
    middles, passed = (np.arange(count) + 0.5) * total / count, 0.0
    for table, begin, end in spans:
        for middle in middles[(middles >= passed) & (middles < passed + end - begin)]:
            start = max(min(begin + float(middle) - passed - 0.5 * length, end - length), begin)
            yield table, start, min(start + length, end)
        passed += end - begin


def _rows(time: Array, first: float) -> NDArray[np.bool_]:
    """Return the samples from `first` [s] on, thinned out to one every `MACHINE_ROW`, shape (n,)."""
    stride = max(round(MACHINE_ROW / float(np.median(np.diff(time)))), 1)
    return (time >= first) & (np.arange(len(time)) % stride == 0)
