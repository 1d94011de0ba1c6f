"""Filters of measured signals: what a balance of forces sees of a position, of a force, and of their noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.signal import savgol_coeffs, savgol_filter

Array = NDArray[np.float64]

#: Position is smoothed over this time: a mass on gas does not move faster, sensors jitter faster [s].
POSITION_SMOOTHING = 0.015
#: Where its noise allows, a velocity passes a filter of this share of the width ...
QUICKER = 0.5
#: ... that is, where four standard deviations of what is left of the noise are no more than this share of its own spread.
QUIET = 0.05
#: What a signal passes, as weights of powers of one Gaussian: `led` alone, and with `restored` behind it.
LED, RESTORED = MappingProxyType({1: 1.0}), MappingProxyType({1: 2.0, 2: -1.0})


@dataclass
class Moved:
    """What a balance of forces needs of a measured position.

    Attributes:
        position, velocity: With what their filter took put back, shape (n,).
        acceleration: Behind the filter that the forces of the balance pass too, shape (n,).
        jitter: Standard deviation of the position's white noise.
        shake: What is left of it in the velocity.
    """

    position: Array
    velocity: Array
    acceleration: Array
    jitter: float
    shake: float


def moved(time: Array, values: Array, seconds: float, jitter: float | None = None) -> Moved:
    """Return how something moved.

    Args:
        time, values: Clock [s] and measured position, shape (n,).
        seconds: Width of the filter of the balance [s].
        jitter: Standard deviation of the position's white noise; taken from it where absent.
    """
    jitter, step = white_noise(values) if jitter is None else jitter, float(np.median(np.diff(time)))
    position, velocity, acceleration = led(time, values, seconds)
    width = seconds
    if 4.0 * jitter * left_of_noise(1, QUICKER * seconds, step, RESTORED) < QUIET * float(np.nanstd(velocity)):
        width = QUICKER * seconds
        position, velocity, _ = led(time, values, width)
    shake = jitter * left_of_noise(1, width, step, RESTORED)
    return Moved(restored(time, position, width), restored(time, velocity, width), acceleration, jitter, shake)


def smooth_window(time: Array, seconds: float = POSITION_SMOOTHING) -> int:
    """Return an odd number of samples that spans about `seconds`, at least 5."""
    usual = float(np.median(np.diff(time)))
    return max(5, 2 * int(round(0.5 * seconds / usual)) + 1)


def smoothed(time: Array, values: Array, seconds: float = POSITION_SMOOTHING) -> tuple[Array, Array, Array]:
    """Return values, first and second derivative by local cubics, shape (n,) each; missing samples are bridged."""
    if not np.isfinite(values).any():
        return values, values, values
    filled, grid, even, usual = _evenly(time, values)
    window = min(smooth_window(time, seconds), 2 * ((len(grid) - 1) // 2) + 1)
    if window < 5:
        return filled, np.gradient(filled, time), np.zeros_like(filled)
    out = [savgol_filter(grid, window, 3, deriv=d, delta=usual, mode="interp") for d in range(3)]
    return _back(time, even, out[0]), _back(time, even, out[1]), _back(time, even, out[2])


def led(time: Array, values: Array, seconds: float) -> tuple[Array, Array, Array]:
    """Return values, first and second derivative, shape (n,) each, all behind the very same filter: a Gaussian of `seconds`' width.

    What a balance of forces needs: derivatives of the smoothed signal, so that nothing but the same smoothing stands on its two sides.
    """
    if not np.isfinite(values).any():
        return values, values, values
    _, grid, even, usual = _evenly(time, values)
    quiet = _gaussian(grid, seconds, usual)
    # differences of the smoothed signal: a cut-off derivative kernel would answer a constant
    rate, bend = np.gradient(quiet, usual), np.zeros_like(quiet)
    bend[1:-1] = (quiet[2:] - 2.0 * quiet[1:-1] + quiet[:-2]) / usual**2
    if len(quiet) > 4:  # of fourth order: on a slow clock the second takes more than the filter
        rate[2:-2] = (8.0 * (quiet[3:-1] - quiet[1:-3]) - (quiet[4:] - quiet[:-4])) / (12.0 * usual)
        bend[2:-2] = (16.0 * (quiet[3:-1] + quiet[1:-3]) - (quiet[4:] + quiet[:-4]) - 30.0 * quiet[2:-2]) / (12.0 * usual**2)
    return _back(time, even, quiet), _back(time, even, rate), _back(time, even, bend)


def quieted(time: Array, values: Array, seconds: float) -> Array:
    """Return the values alone of what `led` returns, shape (n,)."""
    if not np.isfinite(values).any():
        return values
    _, grid, even, usual = _evenly(time, values)
    return _back(time, even, _gaussian(grid, seconds, usual))


def restored(time: Array, smooth: Array, seconds: float) -> Array:
    """Return a signal that has passed the filter with what the filter took of it put back, all but its square, shape (n,).

    A Gaussian takes from the peaks of a velocity; its square, and a cosine of an angle, miss that more than once.
    """
    return 2.0 * smooth - quieted(time, smooth, seconds)


def gaussian_width(seconds: float) -> float:
    """Return the standard deviation [s] of the Gaussian that smooths over about `seconds`."""
    return seconds / 4.0


def left_of_noise(order: int, seconds: float, step: float, passed: Mapping[int, float] = LED) -> float:
    """Return what a filter leaves of white noise of size 1 in a derivative of this order, on a clock that is finer than the filter."""
    s = gaussian_width(seconds)
    power = (1.0 / (2.0 * s), 1.0 / (4.0 * s**3), 3.0 / (8.0 * s**5))[order] / np.sqrt(np.pi)
    both = sum(a * b * (0.5 * (j + k)) ** -(order + 0.5) for j, a in passed.items() for k, b in passed.items())
    return float(np.sqrt(step * power * both))


def white_noise(values: Array | None) -> float:
    """Return the standard deviation of a channel's white noise, from its fourth differences (robust, blind to smooth signals)."""
    if values is None:
        return 0.0
    good = values[np.isfinite(values)]
    if good.size < 20:
        return 0.0
    fourth = np.diff(good, 4) / np.sqrt(70.0)
    spread = 1.4826 * float(np.median(np.abs(fourth - np.median(fourth))))
    if spread > 0.0:
        return spread
    steps = np.abs(np.diff(good))
    steps = steps[steps > 0.0]
    return float(steps.min()) / np.sqrt(12.0) if steps.size else 0.0


def start_filter(points: int) -> Array:
    """Return weights that estimate a value at the start of `points` samples by a local parabola."""
    return savgol_coeffs(points, 2, pos=0, use="dot")


def _gaussian(grid: Array, seconds: float, usual: float) -> Array:
    return gaussian_filter1d(grid, min(gaussian_width(seconds) / usual, 0.02 * len(grid)), mode="nearest")


def _evenly(time: Array, values: Array) -> tuple[Array, Array, Array | None, float]:
    """Return values with gaps bridged, the same on an even clock, that clock (None where it is the own one), and its step [s]."""
    bad = ~np.isfinite(values)
    filled = np.interp(time, time[~bad], values[~bad]) if bad.any() else values
    usual = float(np.median(np.diff(time)))
    even = np.arange(time[0], time[-1] + 0.5 * usual, usual)
    if len(even) == len(time) and np.allclose(even, time, atol=0.02 * usual):
        return filled, filled, None, usual
    return filled, np.interp(even, time, filled), even, usual


def _back(time: Array, even: Array | None, values: Array) -> Array:
    return values if even is None else np.interp(time, even, values)
