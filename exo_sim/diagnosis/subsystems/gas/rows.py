"""Rows of a gas residual: means over short groups of samples, the unknown initial pressure of each window marginalised."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.recording.filters import left_of_noise

Array = NDArray[np.float64]

#: A chamber is at least so long where the noise of its position is weighed, as a share of the stroke.
SHORTEST = 0.01


@dataclass(frozen=True)
class Rows:
    """How the samples of one chamber in one run become rows.

    Attributes:
        group: Row of each sample, -1 where it is not compared, shape (n,).
        window: Window of each row, shape (m,).
        count: Samples of each row, shape (m,).
        scale: Standard deviation that noise, the position's noise and floor leave in each row [Pa], shape (m,).
    """

    group: NDArray[np.int64]
    window: NDArray[np.int64]
    count: Array
    scale: Array

    def means(self, values: Array) -> Array:
        """Return the mean of each row of values at the samples, shape (m,)."""
        keep = self.group >= 0
        return np.bincount(self.group[keep], weights=values[keep], minlength=len(self.count)) / self.count

    def widened(self, spread: Array) -> Rows:
        """Return the same rows with one more reason for errors, of this standard deviation at the samples, shape (n,) [Pa]."""
        if not self.count.size or not spread.any():
            return self
        return replace(self, scale=np.hypot(self.scale, np.sqrt(self.means(spread**2))))

    def beyond(self, values: Array) -> Array:
        """Return what rows cannot follow in values at the samples, shape (k,) for the k samples that are in a row.

        It is what is left beside the means of the rows, or beside a line through the middles of neighbouring rows where that leaves less:
        a slow error that is large in the rows changes inside them, too.
        """
        keep = self.group >= 0
        group, count = self.group[keep], len(self.count)
        means = self.means(values)
        at = np.flatnonzero(keep).astype(float)
        middles = np.bincount(group, weights=at, minlength=count) / self.count
        stepped = values[keep] - means[group]
        sloped = values[keep] - np.interp(at, middles, means)
        squares = [np.bincount(group, weights=part * part, minlength=count) for part in (stepped, sloped)]
        return np.where((squares[1] < squares[0])[group], sloped, stepped)

    def marginalised(self, errors: Array, response: Array) -> Array:
        """Return whitened errors whose squares are the likelihood with each window's initial pressure integrated out, shape (m,).

        With s the response of a window's rows to one prior standard deviation of its initial pressure, the covariance of the errors is
        I + s s'; its inverse square root is applied.

        Args:
            errors, response: Whitened, shape (m,) each.
        """
        count = int(self.window.max()) + 1
        strength = np.bincount(self.window, weights=response * response, minlength=count)
        overlap = np.bincount(self.window, weights=response * errors, minlength=count)
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = np.where(strength > 0.0, (1.0 - 1.0 / np.sqrt(1.0 + strength)) / strength, 0.0)
        return errors - (factor * overlap)[self.window] * response


def rows_of(inputs: GasInputs, side: int, split: Split, seconds: float, on_test: bool, stiffness: Array | None = None) -> Rows:
    """Return the rows of one chamber.

    Args:
        inputs: The run.
        side: 0 or 1.
        split: Which time may be used.
        seconds: Length of a group.
        on_test: Whether the rows are those of the test time, else of the training time.
        stiffness: By how much the pressure rises for each metre that the position is off [Pa/m], shape (n,); nil where absent.
    """
    time = inputs.time
    n = len(time)
    values = inputs.run.pressure[side]
    group = np.full(n, -1)
    if values is None:
        return Rows(group, np.zeros(0, int), np.zeros(0), np.zeros(0))
    good = np.isfinite(values) & inputs.windows.compared
    usable = split.in_test(inputs.run.recording, time) if on_test else split.in_training(inputs.run.recording, time)
    size = max(1, int(round(seconds / float(np.median(np.diff(time))))))
    kept = good & usable
    window_of: list[int] = []
    counts: list[NDArray[np.int64]] = []
    for w, (begin, end) in enumerate(zip(inputs.windows.starts, inputs.windows.stops, strict=True)):
        chosen = np.flatnonzero(kept[begin:end])
        if chosen.size:
            _, row, held = np.unique(chosen // size, return_inverse=True, return_counts=True)
            group[begin + chosen] = len(window_of) + row
            counts.append(held)
            window_of += [w] * len(held)
    count = np.concatenate(counts).astype(float) if counts else np.zeros(0)
    noise = inputs.run.noise[side]
    left = floor(values[good])
    rows = Rows(group, np.array(window_of, dtype=int), count, np.sqrt(noise**2 / np.maximum(count, 1.0) + left**2))
    if stiffness is None or not counts:
        return rows
    moved = inputs.run.position_noise * left_of_noise(time) * rows.means(stiffness)
    return replace(rows, scale=np.hypot(rows.scale, moved))


def floor(pressure: Array) -> float:
    """Return what the model of a healthy machine leaves of a prediction [Pa]; of the pressures that are compared, shape (n,) [Pa]."""
    return max(float(healthy.GAS_FLOOR), healthy.GAS_FLOOR_SHARE * float(np.ptp(pressure)) if pressure.size else 0.0)


def stiffness_of(given: GasInputs, plant: PlantParameters, side: int) -> Array | None:
    """Return by how much a chamber's pressure rises, adiabatically, for each metre that its piston is further in [Pa/m], shape (n,)."""
    measured = given.run.pressure[side]
    if measured is None:
        return None
    c = plant.cylinder[0]
    areas, dead = (float(c["area_1"]), float(c["area_2"])), (float(c["dead_volume_1"]), float(c["dead_volume_2"]))
    depth = given.length if side == 0 else float(c["stroke"]) - given.length
    open_length = np.maximum(depth + dead[side] / areas[side], SHORTEST * float(c["stroke"]))
    pressure = np.where(np.isfinite(measured), measured, np.nanmean(measured))
    return np.asarray(float(plant.world["k"][0]) * pressure / open_length)
