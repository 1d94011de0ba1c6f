"""What a slow logger leaves unknown of a gas: the command of the valve, and the motion of the piston, between two samples.

The contract holds a command until the next sample. A logger that is slower than the control loop takes one of several commands in each of
its periods: the command between two samples is about their mean, and by how much it was not, nobody recorded. What that does to a predicted
pressure adds up within a window as a random walk, whose size goes with the sample period T: of every other sample alone twice as much would
be missing, and the difference of both predictions has sqrt(2^2 - 1) times the standard deviation of what is missing now.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy.recordings import BETWEEN_SAMPLES, SAMPLING_SPAN
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.diagnosis.subsystems.gas.prediction import run_gas

Array = NDArray[np.float64]


def sampling_error(given: GasInputs, plant: PlantParameters) -> Array:
    """Return the standard deviation of a predicted pressure for what happened between samples, shape (n, 2) [Pa].

    Nil where commands are held until the next sample.
    """
    n = len(given.time)
    if not given.run.sampled:
        return np.zeros((n, 2))
    whole = run_gas(given, plant.world, plant.cylinder, whole=False).pressure
    squares = np.zeros((n, 2))
    for first in (0, 1):
        fewer = run_gas(_every_other(given, first), plant.world, plant.cylinder, whole=False).pressure
        squares += 0.5 * (fewer - whole) ** 2
    width = min(n, max(1, int(round(SAMPLING_SPAN / given.period))))
    return np.stack([BETWEEN_SAMPLES * np.sqrt(_mean_about(side, width)) for side in squares.T], axis=1)


def _mean_about(values: Array, width: int) -> Array:
    """Return the mean of finite values over so many samples about each, shape (n,); of all of them where none is near, else 0."""
    known = np.isfinite(values)
    if not known.any():
        return np.zeros(len(values))
    total = np.convolve(np.where(known, values, 0.0), np.ones(width), "same")
    count = np.convolve(known.astype(float), np.ones(width), "same")
    near = np.round(count) > 0.0
    return np.where(near, total / np.maximum(count, 1.0), float(np.mean(values[known])))


def _every_other(given: GasInputs, first: int) -> GasInputs:
    """Return inputs whose commands and positions are known at every other sample, from `first` on, and lines between."""
    kept = np.arange(len(given.time)) % 2 == first

    def between(values: Array) -> Array:
        return np.interp(given.time, given.time[kept], values[kept])

    return replace(
        given, command=between(given.command), command_2=between(given.command_2), length=between(given.length), _delayed=OrderedDict()
    )  # fmt: skip
