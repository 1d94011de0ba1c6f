"""Inputs of a replay: a recording resampled on the simulation's steps."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.filters import forward_filled, smoothed, start_weights
from exo_sim.recording.local_state import LEAST, LocalStates, is_noisy
from exo_sim.recording.table import Recording
from exo_sim.recording.windows import clock_breaks, local_range
from exo_sim.recording.windows import window_starts as starts_of_windows

Array = NDArray[np.float64]

#: Seconds of samples, and the most of them, that estimate the pressure at the start of a window.
START_SECONDS, START_SAMPLES = 0.015, 31


@dataclass(frozen=True)
class Steps:
    """The steps of the simulation over one stretch of a recording's clock.

    Attributes:
        first, last: Samples of the stretch, last excluded.
        time: When each step begins [s], shape (n,), even.
        offset: Number of the stretch's first step in the whole run.
    """

    first: int
    last: int
    time: Array
    offset: int


def steps(time: Array, dt: float, mended: Sequence[float] = ()) -> list[Steps]:
    """Return even steps over every stretch of a clock that does not jump and was not mended (`Recording.breaks`)."""
    edges = [*clock_breaks(time, mended), len(time)]
    found: list[Steps] = []
    offset = 0
    for first, last in itertools.pairwise(edges):
        if last - first < 5:
            continue
        count = math.ceil((time[last - 1] - time[first]) / dt - 1e-6) + 1
        found.append(Steps(first, last, time[first] + dt * np.arange(count), offset))
        offset += count
    return found


def window_starts(pieces: Sequence[Steps], seconds: float, time: Array, pressures: Sequence[Array | None]) -> NDArray[np.int64]:
    """Return the steps at which windows of about `seconds` begin; a window never runs across a jump of the clock.

    Args:
        pieces: The steps.
        seconds: Infinite for one window a stretch.
        time: Of the samples, shape (n,).
        pressures: Measured; windows begin where these are quiet nearby, shape (n,) each.
    """
    starts: list[int] = []
    restless = local_range(pressures, len(time))
    for piece in pieces:
        for cut in starts_of_windows(time, piece.first, piece.last, seconds, restless):
            starts.append(piece.offset + int(np.searchsorted(piece.time, time[cut] - 1e-9)))
    return np.array(starts, dtype=np.int64)


def held(pieces: Sequence[Steps], time: Array, values: Array, early: float = 0.0) -> Array:
    """Return the mean over each step of a value that is held from sample to sample, shape (steps,), each time so much `early` [s]."""
    out = []
    for piece in pieces:
        clock, held_values = time[piece.first : piece.last] - early, forward_filled(values[piece.first : piece.last])
        total = np.concatenate([[0.0], np.cumsum(held_values[:-1] * np.diff(clock))])
        dt = piece.time[1] - piece.time[0] if len(piece.time) > 1 else 1.0
        edges = np.append(piece.time, piece.time[-1] + dt)
        passed = np.interp(edges, clock, total) + np.maximum(edges - clock[-1], 0.0) * held_values[-1]
        out.append(np.diff(passed) / dt)
    return np.concatenate(out)


def between(pieces: Sequence[Steps], time: Array, values: Array | None, otherwise: float, ahead: float = 0.0) -> Array:
    """Return a value between samples, `ahead` seconds after each step's start, shape (steps,); a constant where there is none."""
    if values is None or np.isfinite(values).sum() < 2:
        return np.full(sum(len(piece.time) for piece in pieces), otherwise)
    good = np.isfinite(values)
    return np.concatenate([np.interp(piece.time + ahead, time[good], values[good]) for piece in pieces])


def motion(pieces: Sequence[Steps], time: Array, values: Array, earlier: float) -> tuple[Array, Array]:
    """Return smoothed position at each step and velocity `earlier` seconds before it, shape (steps,) each."""
    position, velocity = [], []
    for piece in pieces:
        clock = time[piece.first : piece.last]
        there, rate, change = smoothed(clock, values[piece.first : piece.last])
        position.append(np.interp(piece.time, clock, there))
        velocity.append(np.interp(piece.time, clock, rate - earlier * change))
    return np.concatenate(position), np.concatenate(velocity)


def start_motion(
    pieces: Sequence[Steps], starts: NDArray[np.int64], time: Array, values: Array, earlier: float
) -> tuple[Array, Array] | None:
    """Return position and velocity, as `motion` does, at the steps at which windows begin, shape (w,) each; None where `motion` will do.

    A window begins with one rate, and all of it strays with that: where the position is noisy it comes of a longer span.
    """
    place, rate = np.full((2, len(starts)), math.nan)
    for piece in pieces:
        own = np.flatnonzero((starts >= piece.offset) & (starts < piece.offset + len(piece.time)))
        clock, there = time[piece.first : piece.last], values[piece.first : piece.last]
        if np.isfinite(there).sum() < LEAST or not is_noisy(clock, there):
            return None
        states = LocalStates(clock, there)
        for w in own:
            found = states.at(float(piece.time[starts[w] - piece.offset]))
            place[w], rate[w] = found.position, found.rate - earlier * found.change
    return place, rate


def start_pressures(pieces: Sequence[Steps], starts: NDArray[np.int64], time: Array, values: Array | None) -> Array:
    """Return the measured pressure at the start of each window, by a local parabola through what follows, shape (w,).

    Over a time, however often it was sampled, in which a filling chamber is little else than a parabola: an error of the start stays in
    the whole window, for nothing is fitted here. The diagnosis of the gas, which does fit it, takes a number of samples instead
    (`_start` of `exo_sim/diagnosis/subsystems/gas/inputs.py`).
    """
    found = np.full(len(starts), math.nan)
    if values is None:
        return found
    for w, start in enumerate(starts):
        piece = next(piece for piece in reversed(pieces) if piece.offset <= start)
        at = int(np.searchsorted(time, piece.time[start - piece.offset] - 1e-9))
        span = values[at : min(piece.last, at + START_SAMPLES)]
        clock = time[at : at + len(span)]
        span = span[clock - clock[0] <= START_SECONDS] if len(clock) else span
        good = np.isfinite(span)
        if not good.any():
            continue
        if good.all() and len(span) >= 5:
            found[w] = float(start_weights(len(span) - 1 + len(span) % 2) @ span[: len(span) - 1 + len(span) % 2])
        else:
            found[w] = float(span[good][0])
    return found


def recorded_joints(recording: Recording, model: mujoco.MjModel) -> list[int]:
    """Return the hinges and slides whose position was recorded, as MuJoCo's indices."""
    return [
        j
        for j in range(model.njnt)
        if model.jnt_type[j] in (2, 3) and has_samples(recording, f"{model.joint(j).name}.position")
    ]


def has_samples(recording: Recording, key: str) -> bool:
    """Return whether a column was recorded and holds at least five samples."""
    values = recording.get(key)
    return values is not None and int(np.isfinite(values).sum()) >= 5
