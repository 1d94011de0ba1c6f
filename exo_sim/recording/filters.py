"""Filters of measured signals, their derivatives, and what they leave of white noise."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from exo_sim.recording import local_polynomial
from exo_sim.recording.noise import PIECE, white_noise

Array = NDArray[np.float64]

#: Positions are smoothed over this time [s]: a mass on gas moves more slowly, sensor noise is faster.
POSITION_SMOOTHING = 0.015
#: A velocity passes a filter of this share of the width if its noise is low enough ...
QUICKER = 0.5
#: ... that is, if four standard deviations of the noise behind that filter are at most this share of the velocity's own spread.
QUIET = 0.05
#: A filter as weights of powers of one Gaussian: `gaussian_derivatives` alone, and followed by `restored`.
SMOOTHED, RESTORED = MappingProxyType({1: 1.0}), MappingProxyType({1: 2.0, 2: -1.0})


@dataclass(frozen=True)
class SmoothedMotion:
    """Motion estimated from a measured position.

    Attributes:
        position, velocity: Smoothed and restored (see `restored`), shape (n,).
        acceleration: Smoothed only, by the filter that the forces of a balance pass too, shape (n,).
        position_noise: Standard deviation of the white noise of the measured position.
        velocity_noise: Standard deviation of the noise left in `velocity`.
    """

    position: Array
    velocity: Array
    acceleration: Array
    position_noise: float
    velocity_noise: float


def smoothed_motion(time: Array, values: Array, seconds: float, noise: float | None = None) -> SmoothedMotion:
    """Return position, velocity and acceleration of a measured position.

    Args:
        time, values: Clock [s] and measured position, shape (n,).
        seconds: Width of the filter [s].
        noise: Standard deviation of the position's white noise; estimated where absent.
    """
    noise, step = white_noise(values) if noise is None else noise, float(np.median(np.diff(time)))
    clock = EvenClock.of(time)
    position, velocity, acceleration = gaussian_derivatives(time, values, seconds, clock)
    width = seconds
    if 4.0 * noise * noise_gain(1, QUICKER * seconds, step, RESTORED) < QUIET * float(np.nanstd(velocity)):
        width = QUICKER * seconds
        del position, velocity  # an hour of each takes 29 MB
        position, velocity = gaussian_derivatives(time, values, width, clock)[:2]
    left = noise * noise_gain(1, width, step, RESTORED)
    position = restored(time, position, width, clock)
    return SmoothedMotion(position, restored(time, velocity, width, clock), acceleration, noise, left)


def smooth_window(time: Array, seconds: float = POSITION_SMOOTHING) -> int:
    """Return an odd number of samples that spans about `seconds`, at least 5."""
    usual = float(np.median(np.diff(time)))
    return max(5, 2 * int(round(0.5 * seconds / usual)) + 1)


def left_of_noise(time: Array, seconds: float = POSITION_SMOOTHING) -> float:
    """Return what `smoothed` leaves of white noise in the values: ratio of standard deviations, that of a local cubic at its middle."""
    m = (smooth_window(time, seconds) - 1) // 2
    return math.sqrt(3.0 * (3.0 * m * m + 3.0 * m - 1.0) / ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0)))


def smoothed(time: Array, values: Array, seconds: float = POSITION_SMOOTHING) -> tuple[Array, Array, Array]:
    """Return values, first and second derivative by local cubics, shape (n,) each; missing samples are bridged."""
    if not np.isfinite(values).any():
        return values, values, values
    filled, grid, even, usual = evenly(time, values)
    window = min(smooth_window(time, seconds), 2 * ((len(grid) - 1) // 2) + 1)
    if window < 5:
        return filled, np.gradient(filled, time), np.zeros_like(filled)
    out = [local_polynomial.filtered(grid, window, 3, d, usual) for d in range(3)]
    return _back(time, even, out[0]), _back(time, even, out[1]), _back(time, even, out[2])


def first_rate_gain(time: Array, seconds: float = POSITION_SMOOTHING) -> float:
    """Return what `smoothed` makes of white noise in the first rate: its standard deviation for one of 1 in the values [1/s]."""
    return float(np.linalg.norm(rate_weights(smooth_window(time, seconds), float(np.median(np.diff(time))), True)))


def gaussian_derivatives(time: Array, values: Array, seconds: float, clock: EvenClock | None = None) -> tuple[Array, Array, Array]:
    """Return values, first and second derivative, shape (n,) each, all smoothed by the same Gaussian of `seconds`' width.

    The derivatives are those of the smoothed signal: both sides of a balance of forces then carry exactly the same smoothing. `clock` is
    that of `time`, if it is known already.
    """
    if not np.isfinite(values).any():
        return values, values, values
    _, grid, even, usual = evenly(time, values, clock)
    quiet = _gaussian(grid, seconds, usual)
    rate, bend = _differences(quiet, usual)
    return _back(time, even, quiet), _back(time, even, rate), _back(time, even, bend)


def _differences(quiet: Array, usual: float) -> tuple[Array, Array]:
    """Return first and second derivative of a smoothed signal, every `usual` [s], shape (n,) each.

    Differences of the smoothed signal: a cut-off derivative kernel would answer a constant. Piece by piece: what is added up on the way
    would take four times as much as an hour's column.
    """
    if len(quiet) <= 4:
        rate, bend = np.gradient(quiet, usual), np.zeros_like(quiet)
        bend[1:-1] = (quiet[2:] - 2.0 * quiet[1:-1] + quiet[:-2]) / usual**2
        return rate, bend
    rate, bend = np.empty_like(quiet), np.zeros_like(quiet)
    rate[:2], rate[-2:] = np.gradient(quiet[:3], usual)[:2], np.gradient(quiet[-3:], usual)[1:]
    bend[1], bend[-2] = ((c - 2.0 * b + a) / usual**2 for a, b, c in (quiet[:3], quiet[-3:]))
    for begin in range(2, len(quiet) - 2, PIECE):  # of fourth order: on a slow clock the second takes more than the filter
        stop = min(begin + PIECE, len(quiet) - 2)
        one = quiet[begin - 2 : stop + 2]
        rate[begin:stop] = (8.0 * (one[3:-1] - one[1:-3]) - (one[4:] - one[:-4])) / (12.0 * usual)
        bend[begin:stop] = (16.0 * (one[3:-1] + one[1:-3]) - (one[4:] + one[:-4]) - 30.0 * one[2:-2]) / (12.0 * usual**2)
    return rate, bend


@dataclass(frozen=True)
class EvenClock:
    """The clock that a filter counts samples on.

    Attributes:
        usual: Usual time between two samples [s].
        even: Times at that distance from each other, shape (m,) [s]; None where the given clock has them already.
    """

    usual: float
    even: Array | None

    @classmethod
    def of(cls, time: Array) -> EvenClock:
        """Return that of a clock, shape (n,) [s]."""
        usual = float(np.median(np.diff(time), overwrite_input=True))
        if _is_even(time, usual):
            return cls(usual, None)
        return cls(usual, np.arange(time[0], time[-1] + 0.5 * usual, usual))


def _is_even(time: Array, usual: float) -> bool:
    """Return whether a clock, shape (n,) [s], goes as evenly as by steps of `usual` from its first time to its last.

    Piece by piece, and no further than it does.
    """
    first, stop = float(time[0]), float(time[-1]) + 0.5 * usual
    if math.ceil((stop - first) / usual) != len(time):
        return False
    step = (first + usual) - first  # as `numpy.arange` adds it up
    pieces = range(0, len(time), PIECE)
    return all(
        np.allclose(first + step * np.arange(begin, min(begin + PIECE, len(time))), time[begin : begin + PIECE], atol=0.02 * usual)
        for begin in pieces
    )


def gaussian_smoothed(time: Array, values: Array, seconds: float, clock: EvenClock | None = None) -> Array:
    """Return the smoothed values that `gaussian_derivatives` returns, shape (n,); `clock` is that of `time`, if it is known already."""
    if not np.isfinite(values).any():
        return values
    _, grid, even, usual = evenly(time, values, clock)
    return _back(time, even, _gaussian(grid, seconds, usual))


def restored(time: Array, smooth: Array, seconds: float, clock: EvenClock | None = None) -> Array:
    """Return a smoothed signal with the filter's attenuation corrected to first order, shape (n,): 2 s - G s (Tukey's twicing).

    A Gaussian lowers the peaks of a velocity, and its square (drag) and the cosine of an angle (gravity) amplify that error. `clock` is
    that of `time`, if it is known already.
    """
    twice = gaussian_smoothed(time, smooth, seconds, clock)
    if twice is smooth:  # no number in it
        return 2.0 * smooth - twice
    return np.subtract(2.0 * smooth, twice, out=twice)


def gaussian_width(seconds: float) -> float:
    """Return the standard deviation [s] of the Gaussian that smooths over about `seconds`."""
    return seconds / 4.0


def noise_gain(order: int, seconds: float, step: float, passed: Mapping[int, float] = SMOOTHED) -> float:
    """Return the standard deviation that a filter leaves of white noise of size 1 in a derivative of this order.

    Args:
        order: Of the derivative, 0 to 2.
        seconds: Width of the filter [s].
        step: Sample interval [s], short against the filter.
        passed: The filter as weights of powers of one Gaussian.
    """
    s = gaussian_width(seconds)
    power = (1.0 / (2.0 * s), 1.0 / (4.0 * s**3), 3.0 / (8.0 * s**5))[order] / np.sqrt(np.pi)
    both = sum(a * b * (0.5 * (j + k)) ** -(order + 0.5) for j, a in passed.items() for k, b in passed.items())
    return float(np.sqrt(step * power * both))


@lru_cache(maxsize=64)  # asked for every window
def start_weights(points: int) -> Array:
    """Return weights that estimate a value at the start of `points` samples by a local parabola; nobody may write to them."""
    weights = local_polynomial.weights(points, 2, at=0)
    weights.flags.writeable = False
    return weights


@lru_cache(maxsize=256)  # asked for every run over the same clock
def rate_weights(points: int, step: float, at_start: bool) -> Array:
    """Return weights that estimate the rate in the middle of `points` samples, or at their start, by a local cubic; as `start_weights`."""
    weights = local_polynomial.weights(points, 3, at=0 if at_start else points // 2, derivative=1, step=step)
    weights.flags.writeable = False
    return weights


def forward_filled(values: Array) -> Array:
    """Return values with each missing sample replaced by the last one before it, by zero where there is none, shape (n,)."""
    good = np.isfinite(values)
    if good.all():
        return values
    index = np.maximum.accumulate(np.where(good, np.arange(len(values)), -1))
    return np.where(index >= 0, values[np.maximum(index, 0)], 0.0)


def _gaussian(grid: Array, seconds: float, usual: float) -> Array:
    return gaussian_filter1d(grid, min(gaussian_width(seconds) / usual, 0.02 * len(grid)), mode="nearest")


def evenly(time: Array, values: Array, clock: EvenClock | None = None) -> tuple[Array, Array, Array | None, float]:
    """Return values with gaps interpolated, the same on an even clock, that clock (None if it is the given one), and its step [s]."""
    there = np.isfinite(values)
    filled = values if there.all() else np.interp(time, time[there], values[there])
    clock = clock or EvenClock.of(time)
    return filled, filled if clock.even is None else np.interp(clock.even, time, filled), clock.even, clock.usual


def _back(time: Array, even: Array | None, values: Array) -> Array:
    return values if even is None else np.interp(time, even, values)
