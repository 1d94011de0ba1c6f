"""How wide the filter of a balance should be, from the noise and the bandwidth of the positions that are differentiated twice.

White noise of a position leaves in an acceleration behind a Gaussian of standard deviation s what goes with s^-5/2; what the restored
motion lacks goes with s^4 of the fastest part of it. Widths are tried one after the other, each wider by a factor: from one to the next the
acceleration changes by noise, whose size is known, and by motion that is lost, which is the rest (neighbours are compared as by Lepski
1991, Theory of Probability and its Applications 35). The width with the least sum of both is asked for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.recordings import FILTER_ENDS, MOVES, NOISY_FALL
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width
from exo_sim.recording.filters import RESTORED, gaussian_derivatives, gaussian_width, noise_gain, restored
from exo_sim.recording.kept_results import kept
from exo_sim.recording.noise import beyond_noise, white_noise
from exo_sim.recording.windows import clock_breaks

Array = NDArray[np.float64]

#: Every width is this much wider than the one before.
WIDER = 1.25
#: The widest filter, as a share of the longest stretch without a jump of the clock: its ends then cost a fifth of it.
WIDEST = 0.08


@dataclass(frozen=True)
class AskedWidth:
    """What the positions of one recording ask of the filter of its balances.

    Attributes:
        seconds: Width of the filter [s].
        noise: Standard deviation of the noise of each position [m or rad], shape (joints,).
        bias: What the restored acceleration of each joint lacks behind a filter that is wider than the least, root mean square
            [m/s^2 or rad/s^2]; 0 behind the least.
    """

    seconds: float
    noise: tuple[float, ...]
    bias: tuple[float, ...]


@dataclass(frozen=True)
class _Risk:
    """What is wrong with an acceleration behind filters of these widths [s]: noise and bias, root mean square, shape (k,) each.

    Attributes:
        position: Standard deviation of white noise of the position that would leave as much.
    """

    widths: Array
    position: Array
    noise: Array
    bias: Array

    @property
    def best(self) -> int:
        return int(np.argmin(self.noise**2 + self.bias**2))

    def last_within(self, most: float) -> int:
        """Return which is the widest filter that is no wider than this [s]; the least where all are."""
        return max(int(np.searchsorted(self.widths, most * (1.0 + 1e-9))) - 1, 0)


def asked_width(time: Array, positions: Sequence[Array], mended: Sequence[float] = (), most: float = math.inf) -> AskedWidth:
    """Return the width that the positions of all joints ask for: that of the joint that moves and asks for the least.

    Args:
        time: Of the samples, shape (n,) [s].
        positions: Of the joints, shape (n,) each.
        mended: Times at which the clock was mended [s].
        most: No wider one is returned, unless the least is [s].
    """
    plain = tuple(white_noise(values) for values in positions)
    least = smoothing_width(time)
    edges = [*clock_breaks(time, mended), len(time)]
    first, last = max(zip(edges, edges[1:], strict=False), key=lambda edge: edge[1] - edge[0])
    risks = [
        _risk(time[first:last], values[first:last], least, noise) if noise > 0.0 and float(np.nanstd(values)) > MOVES * noise else None
        for values, noise in zip(positions, plain, strict=True)
    ]
    moving = [risk for risk in risks if risk is not None]
    wide = min((min(risk.best, risk.last_within(most)) for risk in moving), default=0)
    if wide == 0:
        return AskedWidth(least, plain, (0.0,) * len(plain))
    noises = tuple(noise if risk is None else float(risk.position[wide]) for noise, risk in zip(plain, risks, strict=True))
    biases = tuple(0.0 if risk is None else float(risk.bias[wide]) for risk in risks)
    return AskedWidth(float(moving[0].widths[wide]), noises, biases)


#: Of the joints of some recordings.
@kept(64)
def _risk(time: Array, values: Array, least: float, noise: float) -> _Risk:
    """Return what is wrong with the acceleration of one joint behind filters from the least width on.

    None is tried that is wider than one behind which what motion lost is more than all that is wrong with a narrower one: it only grows,
    and filters of minutes take minutes.
    """
    step, span = float(np.median(np.diff(time))), float(time[-1] - time[0])
    widest = least
    while widest * WIDER < WIDEST * span:
        widest *= WIDER
    ends = math.ceil(2.0 * FILTER_ENDS * gaussian_width(widest) / step)
    inner = slice(ends, max(len(time) - ends, ends))
    widths, changes, expected = [least], list[float](), list[float]()
    last = _restored_acceleration(time, values, least)[inner]
    while True:
        risk = _weighed(widths, changes, expected, noise, step, step * (inner.stop - inner.start))
        if widths[-1] >= widest or _is_beyond(risk):
            return risk
        widths.append(widths[-1] * WIDER)
        now = _restored_acceleration(time, values, widths[-1])[inner]
        changes.append(float(np.sqrt(np.mean((now - last) ** 2))) if now.size else math.inf)
        expected.append(noise * _gain_of_change(widths[-2], widths[-1], step))
        last = now


def _is_beyond(risk: _Risk) -> bool:
    """Return whether all wider filters are worse than one of these: by the last but one, for a change is judged by that which follows."""
    whole = risk.noise**2 + risk.bias**2
    return len(whole) > 2 and bool(risk.bias[-2] ** 2 > whole[risk.best])


def _weighed(
    widths: Sequence[float], changes: Sequence[float], expected: Sequence[float], noise: float, step: float, span: float
) -> _Risk:  # fmt: skip
    """Return what is wrong behind filters of these widths.

    Args:
        widths: Of the filters, shape (k + 1,) [s].
        changes, expected: As of `_coloured`.
        noise: White noise of the position, by its finest differences.
        step, span: Between two samples, and of all that were compared [s].
    """
    factors, lost = _coloured(changes, expected), []
    for change, usual, factor, seconds in zip(changes, expected, factors[1:], widths[1:], strict=True):
        waves = max(span / (2.0 * gaussian_width(seconds)), 1.0)  # of noise: two standard deviations long
        lost.append(beyond_noise(change**2, (factor * usual) ** 2, waves))
    left = np.array([factor * noise_gain(2, seconds, step) for factor, seconds in zip(factors, widths, strict=True)])
    return _Risk(np.array(widths), noise * np.array(factors), noise * left, np.concatenate([[0.0], np.cumsum(lost)]))


def _coloured(changes: Sequence[float], expected: Sequence[float]) -> list[float]:
    """Return by how much the noise at each width exceeds what white noise of its finest differences would be, shape (k + 1,).

    Args:
        changes, expected: Of the acceleration from each width to the next, and what white noise makes of it, shape (k,).
    """
    factors, noisy = [1.0], True
    for k, change in enumerate(changes):
        noisy = noisy and k + 1 < len(changes) and change > changes[k + 1] * WIDER**NOISY_FALL  # behind the first motion all is motion
        factors.append(max(factors[-1], change / expected[k]) if noisy else factors[-1])
    return [factors[min(1, len(factors) - 1)], *factors[1:]]


def _restored_acceleration(time: Array, values: Array, seconds: float) -> Array:
    return restored(time, gaussian_derivatives(time, values, seconds)[2], seconds)


def _gain_of_change(narrow: float, wide: float, step: float) -> float:
    """Return what white noise of size 1 makes of the change of a restored acceleration from one width to another, standard deviation."""
    frequency = np.linspace(0.0, math.pi / step, 4001)
    passed = [np.exp(-0.5 * (frequency * gaussian_width(seconds)) ** 2) for seconds in (narrow, wide)]
    through = [sum(weight * one**power for power, weight in RESTORED.items()) for one in passed]
    return math.sqrt(step / math.pi * float(np.trapezoid(frequency**4 * (through[1] - through[0]) ** 2, frequency)))
