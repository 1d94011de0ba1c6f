"""A quick logger's cylinder on a coarser clock: gas is predicted no more finely than it says anything."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.policy.recordings import FINE_PERIOD, OFTEN_SWITCHED, SWITCHED
from exo_sim.recording.noise import white_noise

Array = NDArray[np.float64]

#: A logger's clock is off by no more than this share.
_CLOCK_ERROR = 0.01


def on_coarse_clock(run: CylinderRun) -> CylinderRun:
    """Return a run whose samples are means of as many neighbours as make `FINE_PERIOD`; the run itself where two are longer.

    Everything measured is the mean over a group of samples, at the mean of their times; of a group that lacks some, over the others.
    A command is held from sample to sample: it is the mean over the time until the next group's, or, where the valve is switched
    meanwhile, what holds for most of it: a mean would be an opening that was never there. A valve that is switched all the time keeps
    its run as it is. Groups hold no break; what is left of a stretch shorter than a group is left out.
    """
    period = float(np.median(np.diff(run.time))) if len(run.time) > 1 else math.inf
    size = int(math.floor(FINE_PERIOD / max(period, 1e-9) * (1.0 + _CLOCK_ERROR))) if math.isfinite(period) else 1
    if size < 2:
        return run
    firsts, breaks = _groups(run, size)
    if len(firsts) < 2 or any(_switches(u) > OFTEN_SWITCHED for u in (run.command, run.command_2) if u is not None):
        return run
    groups = firsts[:, None] + np.arange(size)

    def mean(values: Array) -> Array:
        there = np.isfinite(values[groups])
        count = there.sum(axis=1)
        total = np.where(there, values[groups], 0.0).sum(axis=1)
        return np.where(count > 0, total / np.maximum(count, 1), np.nan)

    def cut(values: Array | None) -> Array | None:
        return None if values is None else mean(values)

    time = mean(run.time)
    pressure = cut(run.pressure[0]), cut(run.pressure[1])
    return replace(
        run, time=time, command=_held(run.time, run.command, time), length=cut(run.length), speed=cut(run.speed), pressure=pressure,
        supply=cut(run.supply), exhaust=cut(run.exhaust), supply_temperature=cut(run.supply_temperature), force=cut(run.force),
        command_2=None if run.command_2 is None else _held(run.time, run.command_2, time), breaks=breaks,
        noise=(white_noise(pressure[0]), white_noise(pressure[1])), position_noise=run.position_noise / math.sqrt(size),
    )  # fmt: skip


def begins_with(time: Array, recorded: Array) -> bool:
    """Return whether a run begins where its recording does: on a coarser clock its first sample is a little later.

    Args:
        time: Of the run [s].
        recorded: Of its recording [s].
    """
    return bool(time[0] - recorded[0] <= FINE_PERIOD)


def _groups(run: CylinderRun, size: int) -> tuple[NDArray[np.int64], tuple[int, ...]]:
    """Return the first sample of each group, and at which groups the run breaks."""
    firsts: list[NDArray[np.int64]] = []
    breaks: list[int] = []
    edges = [*run.breaks, len(run.time)]
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        found = np.arange(begin, end - size + 1, size, dtype=np.int64)
        if found.size:
            breaks.append(sum(len(one) for one in firsts))
            firsts.append(found)
    return np.concatenate(firsts) if firsts else np.zeros(0, np.int64), tuple(breaks)


def _held(time: Array, command: Array, coarse: Array) -> Array:
    """Return what a held command is from each coarse time to the next, shape of `coarse`; the last value holds on."""
    total = np.concatenate([[0.0], np.cumsum(command[:-1] * np.diff(time))])
    means = np.append(np.diff(np.interp(coarse, time, total)) / np.diff(coarse), command[-1])
    first = np.searchsorted(time, coarse, side="right") - 1
    last = np.append(np.searchsorted(time, coarse[1:], side="left") - 1, first[-1])
    switched = np.flatnonzero(np.abs(command[last] - command[first]) > SWITCHED)
    nearer = np.abs(means[switched] - command[first[switched]]) <= np.abs(means[switched] - command[last[switched]])
    means[switched] = np.where(nearer, command[first[switched]], command[last[switched]])
    return means


def _switches(command: Array) -> float:
    """Return the share of samples at which a valve is switched over."""
    return float(np.mean(np.abs(np.diff(command)) > SWITCHED))
