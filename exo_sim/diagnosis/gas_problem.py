"""The gas cut of one cylinder as a least-squares problem: numbers in, whitened pressure errors of the training time out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.fitting import fit
from exo_sim.diagnosis.gas_cut import GasInputs, GasPrediction, inputs, run_gas
from exo_sim.diagnosis.observed import CylinderRun
from exo_sim.diagnosis.quantity import Quantity, Setting
from exo_sim.diagnosis.split import Split
from exo_sim.diagnosis.threads import ALONE, Threads
from exo_sim.physics.gas import critical_ratio

Array = NDArray[np.float64]

#: Windows over which predictions run [s]. Short ones hide slow effects: a fifth to a third of the heat transfer at 0.4 s.
WINDOW = 1.2
#: ... and at least so many samples.
FEWEST_SAMPLES = 150
#: ... while at rest a recording is cut into no more windows than this.
REST_WINDOWS = 5
#: Errors are averaged over this time before they are compared [s] ...
GROUP = 0.005
#: ... and over longer, in proportion, where the recordings are longer than this together [s]: what a fit holds does not grow then.
LONG = 100.0
#: What the smoothed position and the windows' starts leave of the sensor's noise, as pressure [Pa].
STRUCTURAL_FLOOR = 60.0
#: What no sensor and no model of a healthy machine keeps, as a share of the pressure's range.
STRUCTURAL_SHARE = 1.5e-4
#: Below this share of the pressure an error is not worth a name: sensors drift as much.
MATERIAL_SHARE = 1e-4
#: So many times that, and no healthy machine is like it: of 128 healthy benches with oddities three left 16 to 20 times as much.
SICK_TIMES = 22.0
#: How far a start that was estimated from a few samples may be off, in units of the sensor's noise.
START_SPREAD = 1.0
#: The step in start pressure that shows how errors there grow or fade [Pa].
START_STEP = 500.0


@dataclass
class _Rows:
    """How one run's samples become rows: group of each sample (-1: not compared), and window of each group, by side."""

    group: NDArray[np.int64]
    window: NDArray[np.int64]
    count: Array
    scale: Array


class GasProblem:
    """One cylinder, any number of runs.

    Args:
        runs: The runs, each with a position and at least one pressure.
        setting: The machine as believed.
        split: Which time may be used.
        window: Seconds a window.
    """

    unit = "Pa"

    def __init__(
        self,
        runs: Sequence[CylinderRun],
        setting: Setting,
        split: Split,
        window: float | None = None,
        held_out: bool = False,
    ):
        if window is None:
            window = max(WINDOW, FEWEST_SAMPLES * max(float(np.median(np.diff(run.time))) for run in runs))
            if all(run.rests for run in runs):
                window = max(window, max(float(np.ptp(run.time)) for run in runs) / REST_WINDOWS)
        self.setting, self.split, self.all_runs = setting, split, list(runs)
        self._group = GROUP * max(1.0, sum(float(np.ptp(run.time)) for run in runs) / LONG)
        self.runs = (
            list(runs) if held_out else [run for run in (_trained(run, split) for run in runs) if run is not None]
        )
        self.feeds: list[GasInputs] = [inputs(run, setting.world, window) for run in self.runs]
        self._rows = [[self._layout(feed, side, held_out) for side in range(2)] for feed in self.feeds]
        self.blocks = self._blocks()
        self.sides = np.concatenate(
            [np.full(len(rows.count), side) for run in self._rows for side, rows in enumerate(run)] or [np.zeros(0)]
        ).astype(int)
        self._starts: list[list[Array]] | None = None

    def _layout(self, feed: GasInputs, side: int, held_out: bool) -> _Rows:
        time = feed.time
        n = len(time)
        values = feed.run.pressure[side]
        group = np.full(n, -1)
        if values is None:
            return _Rows(group, np.zeros(0, int), np.zeros(0), np.zeros(0))
        good = np.isfinite(values)
        usable = (
            self.split.held_out(feed.run.recording, time) if held_out else self.split.training(feed.run.recording, time)
        )
        size = max(1, int(round(self._group / float(np.median(np.diff(time))))))
        window_of: list[int] = []
        counts: list[int] = []
        for w, (begin, end) in enumerate(zip(feed.windows.starts, feed.windows.stops, strict=True)):
            for first in range(begin, end, size):
                chosen = np.arange(first, min(first + size, end))
                chosen = chosen[good[chosen] & usable[chosen]]
                if chosen.size:
                    group[chosen] = len(counts)
                    counts.append(chosen.size)
                    window_of.append(w)
        count = np.array(counts, dtype=float)
        noise = feed.run.noise[side]
        floor = max(STRUCTURAL_FLOOR, STRUCTURAL_SHARE * float(np.ptp(values[good])) if good.any() else 0.0)
        return _Rows(
            group, np.array(window_of, dtype=int), count, np.sqrt(noise**2 / np.maximum(count, 1.0) + floor**2)
        )

    def _blocks(self) -> NDArray[np.int64]:
        blocks, offset = [], 0
        for run in self._rows:
            for rows in run:
                blocks.append(rows.window + offset)
            offset += 1 + max((int(rows.window.max()) for rows in run if rows.window.size), default=0)
        return np.concatenate(blocks) if blocks else np.zeros(0, int)

    @property
    def size(self) -> int:
        """How many rows the residual has."""
        return int(self.blocks.size)

    @property
    def material(self) -> float:
        """Root-mean-square error that matters, in units of the whitened rows: a small share of the pressure itself."""
        levels = [float(np.nanmean(p)) for run in self.runs for p in run.pressure if p is not None]
        scales = [float(np.median(rows.scale)) for run in self._rows for rows in run if rows.count.size]
        return MATERIAL_SHARE * max(levels, default=0.0) / max(scales, default=1.0)

    @property
    def sick(self) -> float:
        """Root-mean-square error beyond which no healthy machine's gas is, in units of the whitened rows."""
        return SICK_TIMES * self.material

    def apply(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Setting:
        """Return the setting with these numbers put in."""
        setting = self.setting.copy()
        for quantity, value in (*values.items(), *fixed):
            quantity.put(setting, value)
        return setting

    def predict(self, setting: Setting, index: int, shift: float = 0.0, whole: bool = True) -> GasPrediction:
        """Predict what the sensors of one run would show; without `whole` nothing but that."""
        sensors = setting.sensors
        feed = self.feeds[index]
        length_scale = sensors.get("position.scale", 1.0)
        offset = (sensors.get("pressure_1.bias", 0.0), sensors.get("pressure_2.bias", 0.0))
        scale = np.array([sensors.get("pressure_1.scale", 1.0), sensors.get("pressure_2.scale", 1.0)])
        plain = length_scale == 1.0 and (scale == 1.0).all()
        if not plain:
            feed = _seen_through(feed, length_scale, scale, np.array(offset))
        out = run_gas(feed, setting.world, setting.cylinder, shift, sensors.get("position.delay", 0.0), offset, whole)
        pressure = out.pressure
        pressure *= scale
        pressure += np.array(offset)
        for side in range(2):
            late = sensors.get(f"pressure_{side + 1}.delay", 0.0)
            if late != 0.0:
                pressure[:, side] = np.interp(feed.time - late, feed.time, pressure[:, side])
        return GasPrediction(pressure, out.inside, out.drawn, out.temperature)

    def errors(self, setting: Setting) -> list[Array]:
        """Return measured less predicted pressure of every run, shape (n, 2) [Pa]; NaN where nothing was measured."""
        return [self._missed(self.predict(setting, index, whole=False).pressure, index) for index in range(len(self.feeds))]

    def fast_errors(self, setting: Setting) -> list[tuple[Array, float]]:
        """Return what of each pressure's errors the means of the rows do not hold [Pa], shape (n,), and its sensor's noise [Pa].

        Where a row is one sample there is nothing.
        """
        found = []
        for index, errors in enumerate(self.errors(setting)):
            for side, noise in enumerate(self.feeds[index].run.noise):
                rows = self._rows[index][side]
                if rows.count.size and float(np.median(rows.count)) > 2.0:
                    keep = rows.group >= 0
                    found.append((errors[keep, side] - _grouped(errors[:, side], rows)[rows.group[keep]], noise))
        return found

    def _missed(self, predicted: Array, index: int) -> Array:
        """Return measured less predicted pressure of a run, in the place of the predicted."""
        for side, measured in enumerate(self.feeds[index].run.pressure):
            np.subtract(math.nan if measured is None else measured, predicted[:, side], out=predicted[:, side])
        return predicted

    def residual_of(self, setting: Setting) -> Array:
        """Return the whitened errors, cleared of what the unknown starts of the windows explain, shape (size,)."""
        if self._starts is None:
            self._starts = self._start_answers()
        pieces = []
        for index, errors in enumerate(self.errors(setting)):
            for side in range(2):
                rows = self._rows[index][side]
                if rows.count.size:
                    grouped = _grouped(errors[:, side], rows) / rows.scale
                    pieces.append(_cleared(grouped, self._starts[index][side], rows.window))
        return np.concatenate(pieces) if pieces else np.zeros(0)

    def _start_answers(self) -> list[list[Array]]:
        """Return how each row answers one standard deviation of its window's start pressure."""
        answers = []
        for index, feed in enumerate(self.feeds):
            change = self.predict(self.setting, index, START_STEP, whole=False).pressure
            change -= self.predict(self.setting, index, whole=False).pressure
            sides = []
            for side in range(2):
                rows = self._rows[index][side]
                spread = START_SPREAD * max(feed.run.noise[side], STRUCTURAL_FLOOR)
                sides.append(
                    _grouped(change[:, side], rows) / rows.scale * (spread / START_STEP)
                    if rows.count.size
                    else np.zeros(0)
                )
            answers.append(sides)
        return answers

    def either_law(self, nuisances: Sequence[Quantity], threads: Threads = ALONE) -> GasProblem:
        """Return the problem under the form of the paper's flow law that fits better: the nozzle, or the ellipse that approximates it.

        The two differ by at most 0.152 % of choked flow; a healthy valve may follow either, and neither is a finding.
        """
        if float(self.setting.cylinder["critical_ratio"]["ratio"][0]) > 0.0:
            return self
        other = self.setting.copy()
        other.cylinder["critical_ratio"]["ratio"] = critical_ratio(float(self.setting.world["k"][0]))
        rival = copy(self)
        rival.setting = other
        start = {q: q.prior[0] if q.prior else q.neutral for q in nuisances}
        own = fit(self.residual, nuisances, start, threads, most=4)
        known = dict(zip(own.quantities, own.jacobian.T, strict=True))
        costs = own.sse, fit(rival.residual, nuisances, own.values, threads, most=4, known=known).sse
        return rival if costs[1] < costs[0] else self

    def residual(self, values: dict[Quantity, float], fixed: Sequence[tuple[Quantity, float]] = ()) -> Array:
        """Return the whitened, cleared errors for these numbers, shape (size,)."""
        return self.residual_of(self.apply(values, fixed))


def _trained(run: CylinderRun, split: Split) -> CylinderRun | None:
    """Return a run up to the end of its training time, or None where it has none: nothing after it is ever predicted."""
    usable = np.flatnonzero(split.training(run.recording, run.time))
    return run.until(int(usable[-1]) + 1) if usable.size > 20 else None


def _grouped(values: Array, rows: _Rows) -> Array:
    keep = rows.group >= 0
    return np.bincount(rows.group[keep], weights=values[keep], minlength=len(rows.count)) / rows.count


def _cleared(errors: Array, answer: Array, window: NDArray[np.int64]) -> Array:
    """Take out of each window's errors what its start explains; the start's own spread is the prior of that."""
    count = int(window.max()) + 1
    strength = np.bincount(window, weights=answer * answer, minlength=count)
    overlap = np.bincount(window, weights=answer * errors, minlength=count)
    # (I - s s' / (1 + s's))^(1/2) applied, so that squares of the result are the likelihood with the start integrated out
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(strength > 0.0, (1.0 - 1.0 / np.sqrt(1.0 + strength)) / strength, 0.0)
    return errors - (factor * overlap)[window] * answer


def _seen_through(feed: GasInputs, length_scale: float, scale: Array, offset: Array) -> GasInputs:
    """Return the inputs with what the sensors' gains do taken off."""
    starts = feed.windows
    pressure = (starts.pressure - offset) / scale + offset
    return GasInputs(
        feed.run, feed.time, feed.command, feed.length / length_scale, feed.supply, feed.exhaust, feed.supply_temperature,
        type(starts)(starts.starts, starts.stops, pressure), feed._delayed,
    )  # fmt: skip
