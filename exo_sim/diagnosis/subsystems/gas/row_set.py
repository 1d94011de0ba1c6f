"""The rows of a gas' residual over all of its runs: whitened means over short groups, the windows' initial pressures integrated out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy import healthy, priors
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.diagnosis.subsystems.gas.rows import rows_of, stiffness_of
from exo_sim.diagnosis.subsystems.gas.sampling_error import sampling_error

Array = NDArray[np.float64]

#: Errors are averaged over this time [s] ...
GROUP = 0.005
#: ... and in proportion longer where the recordings are longer than this together [s], which bounds the number of rows.
LONG = 100.0
#: Step in the initial pressure for its sensitivity [Pa].
START_STEP = 500.0


class RowSet:
    """The rows of both chambers, run after run.

    Args:
        inputs: Of each run.
        nominal: The nominal plant.
        split: Which time may be used.
        on_test: Whether the rows are those of the test time.

    Attributes:
        unsampled: By run, what happened between samples leaves of a predicted pressure, one standard deviation, shape (n, 2) [Pa].
        rows: By run and side, its rows.
    """

    def __init__(self, inputs: Sequence[GasInputs], nominal: PlantParameters, split: Split, on_test: bool) -> None:
        self._inputs = tuple(inputs)
        group = GROUP * max(1.0, sum(len(one.time) * one.period for one in inputs) / LONG)
        self.unsampled = [sampling_error(one, nominal) for one in inputs]
        self.rows = [
            [rows_of(one, side, split, group, on_test, stiffness_of(one, nominal, side)).widened(unsampled[:, side]) for side in range(2)]
            for one, unsampled in zip(inputs, self.unsampled, strict=True)
        ]

    def blocks(self) -> NDArray[np.int64]:
        """Return the window of each row, counted on from run to run, shape (size,)."""
        blocks, offset = [], 0
        for run in self.rows:
            for rows in run:
                blocks.append(rows.window + offset)
            offset += 1 + max((int(rows.window.max()) for rows in run if rows.window.size), default=0)
        return np.concatenate(blocks) if blocks else np.zeros(0, int)

    @property
    def scale(self) -> Array:
        """Standard deviation that noise and what happened between samples leave in each row [Pa], shape (size,)."""
        return np.concatenate([np.zeros(0), *(rows.scale for run in self.rows for rows in run if rows.count.size)])

    @property
    def usual_scale(self) -> float:
        """Noise of a row, in the noisier chamber [Pa]."""
        return max((float(np.median(rows.scale)) for run in self.rows for rows in run if rows.count.size), default=1.0)

    @property
    def recordings(self) -> NDArray[np.str_]:
        """Of which recording each row is, shape (size,)."""
        named = zip(self._inputs, self.rows, strict=True)
        return np.array([given.run.recording for given, sides in named for rows in sides for _ in range(rows.count.size)], dtype=str)

    @property
    def sides(self) -> tuple[int, ...]:
        """The chambers that have rows, 0 and 1."""
        return tuple(sorted({side for run in self.rows for side, rows in enumerate(run) if rows.count.size}))

    def responses(self, changes: Iterable[Array]) -> list[list[Array]]:
        """Return the response of each row to one standard deviation of its window's initial pressure.

        Args:
            changes: By run, how initial pressures that are `START_STEP` higher change the prediction, shape (n, 2) [Pa].
        """
        found = []
        for given, change, run in zip(self._inputs, changes, self.rows, strict=True):
            sides = []
            for side, rows in enumerate(run):
                spread = priors.INITIAL_PRESSURE * max(given.run.noise[side], healthy.GAS_FLOOR)
                sides.append(rows.means(change[:, side]) / rows.scale * (spread / START_STEP) if rows.count.size else np.zeros(0))
            found.append(sides)
        return found

    def no_responses(self) -> list[list[Array]]:
        """Return the same of windows whose initial pressures are known."""
        return [[np.zeros(rows.count.size) for rows in run] for run in self.rows]

    def whitened(self, errors: Sequence[Array], responses: Sequence[Sequence[Array]]) -> Array:
        """Return errors of every run, shape (n, 2) each [Pa], as rows with the windows' initial pressures integrated out, shape (size,)."""
        pieces = []
        for of_run, run, response in zip(errors, self.rows, responses, strict=True):
            for side, rows in enumerate(run):
                if rows.count.size:
                    pieces.append(rows.marginalised(rows.means(of_run[:, side]) / rows.scale, response[side]))
        return np.concatenate(pieces) if pieces else np.zeros(0)

    def means(self, pressures: Sequence[Array]) -> Array:
        """Return pressures of every run, shape (n, 2) each [Pa], in units of what noise and floor leave of each row, shape (size,)."""
        sides = [(p[:, side], rows) for p, run in zip(pressures, self.rows, strict=True) for side, rows in enumerate(run)]
        return np.concatenate([rows.means(p) / rows.scale for p, rows in sides if rows.count.size])
