"""Position and rate at one moment of a noisy recording: a local cubic over as long a span as noise and motion ask for.

Of a cubic over a span T noise leaves in the rate what goes with T^-3/2; motion that is no cubic leaves what goes with T^3 and more. Spans
are tried one after the other, all along the recording: from one to the next the rate changes by noise, of which the kernels of both say
how much, and by motion, which is the rest. The span with the least sum of both is taken.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from exo_sim.recording.filters import QUIET, evenly, first_rate_gain, rate_weights, smoothed
from exo_sim.recording.kept_results import kept
from exo_sim.recording.noise import beyond_noise, white_noise

Array = NDArray[np.float64]

#: Every span holds so many times the samples of the one before, from the least to the longest one, and no more than a share of all samples.
LONGER, LEAST, MOST, MOST_SHARE = 1.25, 5, 2001, 0.25


@dataclass(frozen=True)
class Span:
    """Over how many samples a rate is taken, and what is wrong with it then.

    Attributes:
        samples: An odd number.
        noise, bias: What noise and what motion leave in the rate, root mean square [1/s times the unit of the values].
    """

    samples: int
    noise: float
    bias: float

    @property
    def error(self) -> float:
        """Both together."""
        return math.hypot(self.noise, self.bias)


@dataclass(frozen=True)
class LocalState:
    """A motion at one moment: value, first and second derivative, and the standard error of the rate."""

    position: float
    rate: float
    change: float
    error: float


class LocalStates:
    """The motion of one stretch of a recording at any of its moments.

    Args:
        time: Without jumps, shape (n,) [s]; n at least 5.
        values: Measured, shape (n,); NaN where missing.
        noise: Standard deviation of their white noise; estimated where absent.
    """

    def __init__(self, time: Array, values: Array, noise: float | None = None) -> None:
        there = np.isfinite(values)
        self._time, self._values = time[there], values[there]
        self._noise = white_noise(values) if noise is None else noise
        _, grid, _, step = evenly(time, values)
        self.inside, self.at_end = (_best_span(grid, step, self._noise, at_start) for at_start in (False, True))

    def at(self, moment: float) -> LocalState:
        """Return the motion at a moment; near an end of the stretch samples are taken from one side."""
        time = self._time
        nearest = int(np.searchsorted(time, moment))
        half = self.inside.samples // 2
        span = self.inside if half <= nearest < len(time) - half else self.at_end
        count = min(span.samples, len(time))
        first = min(max(nearest - count // 2, 0), len(time) - count)
        clock = time[first : first + count] - moment
        length = max(float(np.abs(clock).max()), 1e-12)
        powers = (clock / length)[:, None] ** np.arange(4)
        place, rate, bend, _ = np.linalg.lstsq(powers, self._values[first : first + count], rcond=None)[0]
        return LocalState(float(place), float(rate) / length, 2.0 * float(bend) / length**2, span.error)


def is_noisy(time: Array, values: Array) -> bool:
    """Return whether the rate that `smoothed` returns holds much noise: four standard deviations more than a share of what it varies."""
    return 4.0 * white_noise(values) * first_rate_gain(time) >= QUIET * float(np.nanstd(smoothed(time, values)[1]))


def first_rate_error(time: Array, values: Array) -> float:
    """Return the standard error of the rate with which a motion is begun at the first sample [1/s times the unit of the values]."""
    return LocalStates(time, values).at_end.error if is_noisy(time, values) else white_noise(values) * first_rate_gain(time)


#: Of every position of some recordings, in their middle and at their ends.
@kept(32)
def _best_span(grid: Array, step: float, noise: float, at_start: bool) -> Span:
    """Return the span whose rate is best, in its middle or at its start; at its end it is as good."""
    most = min(MOST, int(MOST_SHARE * len(grid)))
    counts = [LEAST]
    while (more := 2 * (int(max(LONGER * counts[-1], counts[-1] + 2)) // 2) + 1) <= most:
        counts.append(more)
    kernels = [rate_weights(count, step, at_start) for count in counts]
    size = fft.next_fast_len(len(grid) + counts[-1] - 1, real=True)
    spectrum = fft.rfft(grid, size)
    spans = [Span(counts[0], noise * float(np.linalg.norm(kernels[0])), 0.0)]
    for (count, kernel), (longer, other) in itertools.pairwise(zip(counts, kernels, strict=True)):
        ahead = 0 if at_start else (longer - count) // 2
        change = other.copy()
        change[ahead : ahead + count] -= kernel
        found = fft.irfft(spectrum * fft.rfft(change[::-1], size), size)[longer - 1 : len(grid)]
        known = noise * float(np.linalg.norm(change))
        lost = beyond_noise(float(np.mean(found**2)), known**2, len(found) / longer)  # samples a span apart are independent
        spans.append(Span(longer, noise * float(np.linalg.norm(other)), spans[-1].bias + lost))
    return min(spans, key=lambda one: one.error)
