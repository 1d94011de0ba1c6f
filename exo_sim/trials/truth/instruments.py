"""What a measuring card makes of a signal: lag, noise, drift, scale, bits, gaps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Instrument:
    """One channel.

    Attributes:
        noise: White noise, one standard deviation, in the signal's unit.
        slow_noise: Correlated noise, one standard deviation; its correlation time is `slow_time` [s].
        bits: Bits of the converter over `low`..`high`; 0 leaves the value as it is.
        low, high: Range of the converter; outside it the signal clips.
        lag: First-order filter [s].
        delay: Pure delay against the clock [s].
        bias, scale: measured = scale * true + bias.
        drift: Change over the whole recording.
        stuck: Spans (start, stop) [s] in which the last value repeats.
        missing: Spans (start, stop) [s] of NaN.
    """

    noise: float = 0.0
    slow_noise: float = 0.0
    slow_time: float = 0.3
    bits: int = 0
    low: float = -np.inf
    high: float = np.inf
    lag: float = 0.0
    delay: float = 0.0
    bias: float = 0.0
    scale: float = 1.0
    drift: float = 0.0
    stuck: tuple[tuple[float, float], ...] = ()
    missing: tuple[tuple[float, float], ...] = ()


def measure(time: Array, true: Array, instrument: Instrument, rng: np.random.Generator) -> Array:
    """Return what the channel shows at the same times, shape (n,)."""
    steps = np.diff(time, prepend=time[0])
    seen = np.interp(time - instrument.delay, time, true) if instrument.delay else true.astype(float)
    if instrument.lag > 0:
        seen = _first_order(seen, steps, instrument.lag)
    seen = instrument.scale * seen + instrument.bias
    if instrument.drift:
        seen = seen + instrument.drift * (time - time[0]) / max(time[-1] - time[0], 1e-9)
    white = rng.standard_normal(len(time))
    slow = rng.standard_normal(len(time))
    if instrument.slow_noise > 0:
        keep = np.exp(-steps / instrument.slow_time)
        state, wave = slow[0], np.empty(len(time))
        for i, (factor, kick) in enumerate(zip(keep, slow)):
            state = factor * state + np.sqrt(max(1 - factor * factor, 0.0)) * kick if i else kick
            wave[i] = state
        seen = seen + instrument.slow_noise * wave
    seen = np.clip(seen + instrument.noise * white, instrument.low, instrument.high)
    if instrument.bits:
        quantum = (instrument.high - instrument.low) / (2**instrument.bits - 1)
        seen = instrument.low + np.round((seen - instrument.low) / quantum) * quantum
    for start, stop in instrument.stuck:
        rows = np.flatnonzero((time >= start) & (time < stop))
        if len(rows):
            seen[rows] = seen[rows[0]]
    for start, stop in instrument.missing:
        seen[(time >= start) & (time < stop)] = np.nan
    return seen


def _first_order(values: Array, steps: Array, lag: float) -> Array:
    """Return the exact answer of a first-order filter to straight lines between the samples."""
    out = np.empty_like(values)
    state = out[0] = values[0]
    for i in range(1, len(values)):
        h = steps[i] / lag
        keep = np.exp(-h)
        slope = (values[i] - values[i - 1]) / h
        state = keep * state + (1 - keep) * (values[i - 1] - slope) + slope * h
        out[i] = state
    return out
