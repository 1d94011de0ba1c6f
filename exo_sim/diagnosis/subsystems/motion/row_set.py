"""The rows of one balance of forces in all its recordings, in one order: those of motion, then those of its onsets where they count."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.excerpt import spread
from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.kept_residuals import KeptResiduals
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.subsystems.motion.missing_force import MissingOnsets, MissingRows, around
from exo_sim.diagnosis.subsystems.motion.onsets import Onsets
from exo_sim.diagnosis.subsystems.motion.rows import Rows, rows_of

Array = NDArray[np.float64]

_NOTHING: Array = np.zeros(0)
_NO_NUMBERS: NDArray[np.int64] = np.zeros(0, dtype=int)


class RowSet:
    """The rows of a balance.

    Args:
        runs: The balance in every recording.
        usable: Which samples of each may be used.
        rows: Of the motion, of each.
        fitted: What the rows of the motion lack.
        onsets: Of each recording whose onsets count, with its number.
    """

    def __init__(
        self, runs: Sequence[MotionRun], usable: Sequence[NDArray[np.bool_]], rows: Sequence[Rows], fitted: Sequence[MissingRows],
        onsets: Sequence[tuple[int, Onsets]] = (),
    ):  # fmt: skip
        self.runs, self.usable, self.rows, self._fitted = tuple(runs), tuple(usable), tuple(rows), tuple(fitted)
        self._kept = KeptResiduals()
        self._parts: list[tuple[int, Rows | Onsets]] = [*enumerate(rows), *onsets]
        self._onsets = [one for _, one in onsets]
        self._starting = [MissingOnsets(runs[number], one) for number, one in onsets]
        counts = np.zeros(len(rows), dtype=int)
        for number, one in self._parts:
            counts[number] = max(counts[number], int(one.block.max(initial=-1)) + 1)
        before = np.cumsum(counts) - counts
        self.blocks: NDArray[np.int64] = np.concatenate([_NO_NUMBERS, *(one.block + before[number] for number, one in self._parts)])
        self.recording: NDArray[np.int64] = np.concatenate([_NO_NUMBERS, *(np.full(one.block.size, at) for at, one in self._parts)])
        self.scale: Array = np.concatenate([_NOTHING, *(one.scale for _, one in self._parts)])

    @classmethod
    def of(cls, runs: Sequence[MotionRun], split: Split, on_test: bool) -> RowSet:
        """Return the rows of the motion in the training time of a split, of a long recording some of them, or in all its test time."""
        masks = [(split.in_test if on_test else split.in_training)(run.recording, run.time) for run in runs]
        is_thinned = False
        if not on_test:
            total = sum(float(np.ptp(run.time)) for run in runs)
            kept = [spread(run.time, total) for run in runs]
            masks, is_thinned = [mask & one for mask, one in zip(masks, kept, strict=True)], not all(one.all() for one in kept)
        rows = [rows_of(run, usable) for run, usable in zip(runs, masks, strict=True)]
        parts = list(zip(runs, rows, strict=True))
        if is_thinned:
            parts = [part for run, own in parts for part in around(run, own)]
        return cls(runs, masks, rows, [MissingRows(run, own) for run, own in parts if own.compared.any()])

    def with_onsets(self, onsets: Sequence[tuple[int, Onsets]]) -> RowSet:
        """Return the same rows, and behind them these onsets, each with the number of its recording."""
        return RowSet(self.runs, self.usable, self.rows, self._fitted, onsets)

    @property
    def of_motion(self) -> int:
        """How many rows are of the motion: the first of them."""
        return sum(one.block.size for one in self.rows)

    def means(self, values: Callable[[MotionRun], Array]) -> Array:
        """Return what each row has of a signal of its run, shape (size,)."""
        return np.concatenate([_NOTHING, *(one.means(values(self.runs[number])) for number, one in self._parts)])

    @property
    def velocity(self) -> Array:
        """Mean velocity of each row of the motion [m/s or rad/s], shape (size,).

        An onset has none that is known; it stands at the least speed at which rows say how friction slides, in its direction, or where
        there are none at its own as it breaks loose.
        """
        of_motion = np.concatenate([_NOTHING, *(one.means(run.kinematics.velocity) for run, one in zip(self.runs, self.rows, strict=True))])
        least = float(np.abs(of_motion).min(initial=math.inf))
        return np.concatenate([of_motion, *((least if of_motion.size else one.slowest) * one.way for one in self._onsets)])

    def onset_peaks(self, constant: float) -> Array:
        """Return what resists at the peak of each onset beside damping and a constant force [N or N m], shape (k,)."""
        return np.concatenate([_NOTHING, *(one.peak - constant * one.way for one in self._onsets)])

    def missing(self, plant: PlantParameters) -> Array:
        """Return the force that the balance lacks in each row [N or N m], shape (size,); nobody may write to it."""
        return self._kept.of(plant, self._missing)

    def _missing(self, plant: PlantParameters) -> Array:
        return np.concatenate([_NOTHING, *(one.of(plant) for one in self._fitted), *(one.of(plant) for one in self._starting)])
