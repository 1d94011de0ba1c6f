"""Inputs of a gas prediction: a run cut into windows, what was not recorded filled with the rig's constants."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass, field, replace
from functools import cached_property
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.policy.recordings import LEAD_IN, WORTH_A_LEAD_IN
from exo_sim.diagnosis.subsystems.gas.arrived_commands import ArrivedCommands, late_commands
from exo_sim.recording.filters import start_weights
from exo_sim.recording.windows import local_range, window_starts

Array = NDArray[np.float64]

#: Delayed commands are kept up to so many samples, the latest at least: a fit asks for a few delays again and again, then never more.
MOST_KEPT = 400_000
#: Samples that estimate the pressure at the start of a window, and the longest time that they may span [s].
START_SAMPLES, START_SECONDS = 15, 0.03


@dataclass(frozen=True)
class Windows:
    """Where predictions start and end.

    Attributes:
        starts, stops: First sample of each window and the one behind its last, shape (w,).
        pressure: Initial pressures, shape (w, 2): as measured; of a chamber that was not measured `CylinderRun.initial` at the very
            first, else NaN.
        lead: Whether a window only leads in: what the valve does in it hangs on commands from before, and it is not compared, shape (w,).
    """

    starts: NDArray[np.int64]
    stops: NDArray[np.int64]
    pressure: Array
    lead: NDArray[np.bool_]

    @cached_property
    def compared(self) -> NDArray[np.bool_]:
        """Whether each sample is in a window that is compared, shape (n,)."""
        return np.repeat(~self.lead, self.stops - self.starts)


@dataclass(frozen=True)
class GasInputs:
    """Inputs of one run, shape (n,) each; supply and exhaust are the rig's constants where they were not recorded.

    With them goes the longest step of a prediction of what sensors behind a hose show, `hose_step` [s]; 0 is the usual one.
    """

    run: CylinderRun
    time: Array
    command: Array
    length: Array
    supply: Array
    exhaust: Array
    supply_temperature: Array
    windows: Windows
    command_2: Array
    hose_step: float = 0.0
    _delayed: OrderedDict[tuple[float, float, float], ArrivedCommands] = field(default_factory=OrderedDict)
    _lock: Lock = field(default_factory=Lock)

    @cached_property
    def period(self) -> float:
        """Usual time between two samples [s]."""
        return float(np.median(np.diff(self.time)))

    def command_after(self, delay: float, closing: float = 0.0, reversal: float = 0.0) -> ArrivedCommands:
        """Return the commands towards both chambers as they reach the valve `delay` seconds late, and `closing` later still to close it.

        How a spool gets straight from one side to the other is `reversal`, of `valve_lag.REVERSALS`.

        Of commands that are samples of a quicker loop those between two are about their mean: as if each were held from half a sample
        before it on.
        """
        delay -= 0.5 * self.period if self.run.sampled else 0.0
        key = delay, closing, reversal
        with self._lock:
            if key in self._delayed:
                self._delayed.move_to_end(key)
                return self._delayed[key]
        found = late_commands(self.time, np.stack([self.command, self.command_2], axis=1), *key)
        with self._lock:
            self._delayed[key] = found
            while len(self._delayed) > max(1, MOST_KEPT // len(self.time)):
                self._delayed.popitem(last=False)
        return found


def inputs(run: CylinderRun, world: NDArray[np.void], seconds: float) -> GasInputs:
    """Return the inputs of a run for windows of about `seconds`; `world` is the record of shape (1,) with the constants."""
    n = len(run.time)
    assert run.length is not None
    record = world[0]

    def constant(values: Array | None, name: str) -> Array:
        return np.full(n, float(record[name])) if values is None else values

    return GasInputs(
        run, run.time, run.command, run.length, supply=constant(run.supply, "supply_pressure"),
        exhaust=constant(run.exhaust, "exhaust_pressure"),
        supply_temperature=constant(run.supply_temperature, "supply_temperature"), windows=windows(run, seconds), command_2=run.towards(1),
    )  # fmt: skip


def windows(run: CylinderRun, seconds: float) -> Windows:
    """Cut a run into windows of about `seconds` that contain no break, each started where the pressures are quiet nearby.

    Where a valve works, a stretch begins with a window that leads in.
    """
    starts: list[int] = []
    stops: list[int] = []
    lead: list[bool] = []
    time = run.time
    restless = local_range(run.pressure, len(time))
    edges = [*run.breaks, len(time)]
    works = run.commanded and not run.at_rest
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        first = begin
        if works and end > begin and time[end - 1] - time[begin] > WORTH_A_LEAD_IN * LEAD_IN:
            first += int(np.searchsorted(time[begin:end], time[begin] + LEAD_IN))
        found = [begin] * (first > begin) + window_starts(time, first, end, seconds, restless)
        starts += found
        stops += [*found[1:], end]
        lead += [start < first for start in found]
    pressure = np.full((len(starts), 2), np.nan)
    points = _start_points(time)
    for side, values in enumerate(run.pressure):
        if values is None:
            pressure[0, side] = run.initial[side]
            continue
        for w, (begin, end) in enumerate(zip(starts, stops, strict=True)):
            pressure[w, side] = _start(values[begin:end], points)
    return Windows(np.array(starts), np.array(stops), pressure, np.array(lead))


def with_late_pressures(given: GasInputs, late: tuple[float, float]) -> GasInputs:
    """Return inputs whose windows start from what the sensors of both pressures show `late` seconds after the start [s]."""
    run, starts = given.run, given.windows.starts
    points = _start_points(run.time)
    pressure = given.windows.pressure.copy()
    for side, (values, seconds) in enumerate(zip(run.pressure, late, strict=True)):
        if values is None or seconds == 0.0:
            continue
        at = np.interp(run.time[starts] + seconds, run.time, np.arange(len(run.time)))
        for w, (place, stop) in enumerate(zip(at, given.windows.stops, strict=True)):
            first = int(place)
            ends = [_start(values[i : max(stop, i + points)], points) for i in (first, min(first + 1, len(values) - 1))]
            shown = ends[0] + (place - first) * (ends[1] - ends[0])
            if math.isfinite(shown):
                pressure[w, side] = shown
    return replace(given, windows=replace(given.windows, pressure=pressure))


def _start_points(time: Array) -> int:
    """Return how many samples estimate the pressure at the start of a window."""
    return min(START_SAMPLES, int(START_SECONDS / max(float(np.median(np.diff(time))), 1e-9)) + 1) if len(time) > 1 else 1


def _start(values: Array, points: int) -> float:
    """Return the pressure at the start of a window [Pa] by a local parabola through `points` samples; the first there is where any lacks.

    A number of samples, of as much noise at 500 Hz as at 1 kHz: what the noise of a start does to a window is a nuisance of the fit
    (`rows.py`). A replay has no such nuisance and takes a time instead (`exo_sim.simulation.replay.inputs.start_pressures`). One estimate
    for both moved what recordings of 200 Hz answer, some of it for the worse. At 1 kHz and in a gas at rest both are one.
    """
    good = np.isfinite(values)
    if not good.any():
        return math.nan
    points = min(points, len(values))
    if points < 5 or not good[:points].all():
        return float(values[int(np.argmax(good))])
    return float(start_weights(points) @ values[:points])
