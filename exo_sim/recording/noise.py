"""How much of a signal is noise: white part, correlated part and quantisation, separated from the motion under it.

Differences of third order let a smooth signal through only as the sixth power of the sample interval, white noise
unchanged, and noise of correlation time tau somewhere between. So their variance V is taken over strides of s = 1, 2,
4, ... samples and the non-negative sum

    V(s) = 20 w^2 + g(exp(-s dt / tau)) c^2 + a s^6,    g(r) = 20 - 30 r + 12 r^2 - 2 r^3

is fitted: w is the white part, c the part correlated over tau, a the signal. (20 = 1 + 9 + 9 + 1, the squared
binomials; the other numbers are their products at lags 1, 2, 3.) Each V is a low quantile over blocks of time, so that
valve switching, impacts and stick-slip in up to half of the blocks do not count. Noise slower than about ten samples
cannot be distinguished from motion this way and is left out.

`floor` does this: it says what a channel shows where nothing moves, and errors and oddities are held against it. `white_noise`
is quicker and asks for no clock. It sees the white part alone, which is what a filter thins out and what the rows of a fit are
weighted by; what neighbouring samples share, the fit sees for itself as correlation of its residuals. Where all noise is white
both say the same.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.recording.kept_results import kept
from exo_sim.recording.table import Recording

_STRIDES = (1, 2, 4, 8, 16)
_BLOCK = 256
_QUANTILE, _NORMAL_QUANTILE = 0.3, -0.5244005127080409
_MOST_SAMPLES = 200_000
_CORRELATIONS = np.concatenate(([0.0], np.exp(-1.0 / np.geomspace(0.4, 10.0, 24))))  # of neighbouring samples

#: Long columns are gone through in pieces of so many samples where what is worked out on the way would take as much again.
PIECE = 1 << 16
#: Of fewer finite samples nothing is said of noise.
FEWEST_FOR_NOISE = 20
#: A change is more than noise where its square exceeds that by so many standard errors.
BEYOND_CHANCE = 2.0


@dataclass(frozen=True)
class Noise:
    """The noise of one column, in its unit.

    Attributes:
        std: Standard deviation of all noise, quantisation included; 0 where none can be seen.
        white: The part independent from sample to sample, quantisation taken off.
        correlated: The part that neighbouring samples share.
        correlation_time: Seconds over which it decays by e; 0 where it is white.
        step: Quantisation step; 0 where values are not on a grid.
        signal_share: How much of the finest differences is signal after all; near 1 makes `std` an upper bound.
    """

    std: float
    white: float
    correlated: float
    correlation_time: float
    step: float
    signal_share: float


def floor(values: NDArray[np.float64], time: NDArray[np.float64]) -> Noise:
    """Estimate the noise of one column.

    Args:
        values: Shape (n,), NaN where missing.
        time: Seconds, shape (n,), strictly increasing; only samples at about the usual interval are compared.
    """
    values, time = _thinned(values, time)
    present = np.isfinite(values)
    # near 1, so that squares are numbers; a power of two, so that no bit is lost
    power = int(np.frexp(np.abs(values[present]).max(initial=0.0))[1])
    found = _floor(np.ldexp(values, -power), time, present)
    std, white, correlated, step = (float(np.ldexp(each, power)) for each in (found.std, found.white, found.correlated, found.step))
    return Noise(std, white, correlated, found.correlation_time, step, found.signal_share)


#: As many columns as a diagnosis goes through again for every rig that it tries.
@kept(256)
def _floor(values: NDArray[np.float64], time: NDArray[np.float64], present: NDArray[np.bool_]) -> Noise:
    step = quantum(values)
    if present.sum() < 8:
        return Noise(step / np.sqrt(12.0), 0.0, 0.0, 0.0, step, 0.0)
    interval = float(np.median(np.diff(time)))
    strides, variances = _variances(values, time, interval)
    if not len(variances) or not variances[0] > 0.0:
        return Noise(step / np.sqrt(12.0), 0.0, 0.0, 0.0, step, 0.0)
    white, correlated, correlation, signal = _parts(strides, variances)
    if correlation >= _CORRELATIONS[-1]:  # as slow as motion: nothing but an upper bound can be had
        share = 1.0 - 20.0 * white / variances[0]
        return Noise(float(np.sqrt(variances[0] / 20.0)), float(np.sqrt(white)), 0.0, 0.0, step, float(max(share, 0.0)))
    rounding = step**2 / 12.0
    tau = -interval / np.log(correlation) if correlation > 0.0 and correlated > 0.0 else 0.0
    return Noise(
        std=float(np.sqrt(max(white + correlated, rounding))),
        white=float(np.sqrt(max(white - rounding, 0.0))),
        correlated=float(np.sqrt(correlated)),
        correlation_time=float(tau),
        step=step,
        signal_share=float(signal / variances[0]),
    )


def white_noise(values: NDArray[np.float64] | None) -> float:
    """Return the standard deviation of a channel's white noise, from the median of its fourth differences (smooth signals vanish there).

    Args:
        values: At even times, shape (n,), NaN where missing; None for a channel that is not there, which has none. Of fewer than
            `FEWEST_FOR_NOISE` nothing is said, of a channel that mostly stands still the share of its quantisation.
    """
    if values is None:
        return 0.0
    good = finite(values)
    if good.size < FEWEST_FOR_NOISE:
        return 0.0
    spread = _own_deviation(_fourth_differences(good))
    if spread > 0.0:
        return spread
    steps = np.abs(np.diff(good))
    steps = steps[steps > 0.0]
    return float(steps.min()) / np.sqrt(12.0) if steps.size else 0.0


def finite(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the finite ones of some values, shape (m,): the array itself, shape (n,), where all are."""
    there = np.isfinite(values)
    return values if there.all() else values[there]


def _fourth_differences(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return fourth differences of values, shape (n,), in units of what white noise of size 1 makes of them, shape (n - 4,).

    Piece by piece: of an hour each array of differences takes as much as the column.
    """
    found = np.empty(len(values) - 4)
    for begin in range(0, len(found), PIECE):
        part = found[begin : begin + PIECE]
        np.divide(np.diff(values[begin : begin + len(part) + 4], 4), np.sqrt(70.0), out=part)
    return found


def floors(recording: Recording) -> Mapping[str, Noise]:
    """Estimate the noise of every column."""
    return {key: floor(values, recording.time) for key, values in recording.columns.items()}


def quantum(values: NDArray[np.float64]) -> float:
    """Return the step of the grid that all values lie on, 0 where there is none."""
    present = values[np.isfinite(values)]
    distinct = np.unique(present)
    if len(distinct) < 3 or len(distinct) > 0.9 * len(present):  # no value twice: a ramp is no grid
        return 0.0
    gaps = np.diff(distinct)
    gaps = gaps[gaps > 1e-9 * np.abs(distinct[[0, -1]]).max()]
    if len(gaps) < 2:
        return 0.0
    step = float(gaps.min())
    near = gaps[gaps < 200.0 * step]
    if len(near) < max(3, 0.2 * len(gaps)):
        return 0.0
    step = float(np.mean(near / np.rint(near / step)))
    off_grid = np.abs(near / step - np.rint(near / step))
    if np.mean(off_grid > 0.05) > 0.01:
        return 0.0
    return step


def _thinned(values: NDArray[np.float64], time: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Take eight stretches spread over a long recording; the seams are gaps in the clock."""
    if len(values) <= _MOST_SAMPLES:
        return values, time
    length = _MOST_SAMPLES // 8
    starts = np.linspace(0, len(values) - length, 8).astype(int)
    rows = np.concatenate([np.arange(start, start + length) for start in starts])
    return values[rows], time[rows]


def _variances(
    values: NDArray[np.float64], time: NDArray[np.float64], interval: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    strides, variances = [], []
    centred = values - np.nanmedian(values)
    for stride in _STRIDES:
        span = 3 * stride
        if len(values) < max(2 * span, span + 8):
            break
        third = (
            centred[span:] - 3.0 * centred[2 * stride : -stride] + 3.0 * centred[stride : -2 * stride] - centred[:-span]
        )
        even = np.abs(time[span:] - time[:-span] - span * interval) < max(0.5, 0.1 * span) * interval
        squares = np.where(even, third, np.nan) ** 2
        estimate = _low_mean(squares)
        if estimate is None:
            break
        strides.append(float(stride))
        variances.append(estimate)
    return np.array(strides), np.array(variances)


def _low_mean(squares: NDArray[np.float64]) -> float | None:
    """Return the mean square of the quiet blocks, from a low quantile over blocks (Wilson and Hilferty 1931)."""
    size = min(_BLOCK, max(8, len(squares) // 8))
    blocks = squares[: len(squares) // size * size].reshape(-1, size)
    whole = np.isfinite(blocks).mean(axis=1) > 0.8
    if not whole.any():
        return None
    blocks = blocks[whole]
    means = np.nanmean(blocks, axis=1)
    alive = means > 0.0
    if alive.any() and np.median(np.mean(blocks[alive] == 0.0, axis=1)) < 0.5:
        means = means[alive]  # a sensor that shows noise has stopped where it shows none
    spread = 2.0 / (9.0 * 0.5 * size)
    if len(means) < 4:
        return float(np.median(means))
    return float(np.quantile(means, _QUANTILE) / (1.0 - spread + _NORMAL_QUANTILE * np.sqrt(spread)) ** 3)


def _parts(strides: NDArray[np.float64], variances: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Return the white and correlated variance, the correlation of neighbours, and the signal's share of V(1)."""
    from scipy.optimize import nnls

    variances = np.maximum(variances, 1e-9 * variances.max())  # every other sample alike: of some strides nothing is left
    white = np.full_like(strides, 20.0)
    signal = strides**6
    best: tuple[float, tuple[float, float, float, float]] | None = None
    for correlation in _CORRELATIONS:
        r = correlation**strides
        correlated = 20.0 - 30.0 * r + 12.0 * r**2 - 2.0 * r**3
        columns = [white, signal] if correlation == 0.0 else [white, signal, correlated]
        design = np.column_stack(columns) / variances[:, None]  # relative errors
        scale = np.linalg.norm(design, axis=0)
        weights, misfit = nnls(design / scale, np.ones_like(variances))
        weights = weights / scale
        # a correlated part must earn its two numbers
        cost = misfit + (0.0 if correlation == 0.0 else 0.05 * np.sqrt(len(strides)))
        if best is None or cost < best[0]:
            extra = float(weights[2]) if correlation > 0.0 else 0.0
            best = cost, (float(weights[0]), extra, float(correlation), float(weights[1]))
    assert best is not None
    return best[1]


def by_chance(independent: float) -> float:
    """Return the most that a mean square of so many independent values of noise is, in units of its expectation, but for chance."""
    return 1.0 + BEYOND_CHANCE * math.sqrt(2.0 / independent)


def beyond_noise(square: float, noise: float, independent: float) -> float:
    """Return what a change holds beside noise, root mean square; 0 where it is no larger than noise by itself may be.

    Args:
        square: Mean square of the change.
        noise: The same that noise makes of it.
        independent: How many independent values the mean is of.
    """
    return math.sqrt(square - noise) if square > by_chance(independent) * noise else 0.0


def robust_deviation(values: NDArray[np.float64]) -> float:
    """Return the standard deviation of normal values but for some that are far off: 1.4826 median absolute deviations."""
    return _own_deviation(np.array(values, dtype=float))


def _own_deviation(values: NDArray[np.float64]) -> float:
    """Return the same of an array that nobody needs any more."""
    middle = np.median(values, overwrite_input=True)
    np.abs(np.subtract(values, middle, out=values), out=values)
    return 1.4826 * float(np.median(values, overwrite_input=True))
