"""What the cards of a rig make of its signals: a filter and a delay that all channels of a card share, noise, steps, offsets, gaps."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import bessel, butter, lfilter

from exo_sim.trials.whole_machines.make import Grade

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Channel:
    """One channel.

    Attributes:
        noise: White noise, one standard deviation.
        step: Step of the converter or encoder, 0 for none.
        low, high: Range; outside it the signal clips.
        cutoff: Of the card's filter [Hz], 0 for none.
        order: Of the filter.
        shape: Of the filter: "bessel", which delays all alike, or "butterworth".
        delay: Of the card against the clock [s].
        offset, scale: shown = scale * true + offset.
    """

    noise: float = 0.0
    step: float = 0.0
    low: float = -math.inf
    high: float = math.inf
    cutoff: float = 0.0
    order: int = 1
    delay: float = 0.0
    offset: float = 0.0
    scale: float = 1.0
    shape: str = "bessel"

    @property
    def spread(self) -> float:
        """Noise and steps together, one standard deviation."""
        return math.hypot(self.noise, self.step / math.sqrt(12.0))

    @property
    def late(self) -> float:
        """Delay of the filter at low frequencies and of the card together [s]."""
        if self.cutoff <= 0.0:
            return self.delay
        b, a = _filter(self, 2 * math.pi * self.cutoff, analog=True)
        return self.delay + float(a[-2] / a[-1] - (b[-2] / b[-1] if len(b) > 1 else 0.0))

    def plain(self) -> dict[str, float]:
        """Return its numbers, with what is late altogether."""
        numbers = {key: float(value) for key, value in vars(self).items() if key != "shape" and math.isfinite(value)}
        return {**numbers, "late": self.late}


def _filter(channel: Channel, cutoff: float, analog: bool = False) -> tuple[Array, Array]:
    """Return numerator and denominator of a channel's filter; the cut-off is in rad/s, or a share of half the sample rate."""
    if channel.shape == "butterworth":
        b, a = butter(channel.order, cutoff, analog=analog)
    else:
        b, a = bessel(channel.order, cutoff, analog=analog, norm="mag")
    return b, a


@dataclass(frozen=True)
class Rack:
    """The channels of a rig."""

    pressure_1: Channel
    pressure_2: Channel
    supply: Channel
    position: Channel
    force: Channel
    jitter: float


def draw_rack(grade: Grade, rng: np.random.Generator, lever_arm: float, force_range: float, ambient: float, believed: float) -> Rack:
    """Draw the instruments of a rig.

    Args:
        grade: Of the make.
        rng: Chance.
        lever_arm: Metres at the rod for a radian of the joint; 1 on a slide.
        force_range: Full scale of a load cell [N].
        ambient, believed: Room pressure as it is and as it was added to gauge readings [Pa].
    """
    levels = 2**grade.bits - 1
    cutoff = float(rng.uniform(*grade.filter_hz))
    late = float(rng.uniform(*grade.card_delay))
    noise = float(rng.uniform(*grade.pressure_noise))
    room = believed - ambient if grade.gauge else 0.0

    def pressure() -> Channel:
        offset = room + float(rng.normal(0, grade.offset))
        step = grade.pressure_range / levels
        return Channel(noise, step, 0.0, grade.pressure_range, cutoff, grade.filter_order, late, offset, shape=grade.filter_shape)

    if grade.encoder:
        position = Channel(0.0, float(rng.choice(grade.encoder)) / lever_arm)
    else:
        noise_x = float(rng.uniform(*grade.position_noise)) / lever_arm
        position = Channel(noise_x, 0.0, cutoff=1.5 * cutoff, order=grade.filter_order, delay=0.3 * late, shape=grade.filter_shape)
    scale = 1.0 + float(np.clip(rng.normal(0, grade.force_scale), -2 * grade.force_scale, 2 * grade.force_scale))
    force = Channel(
        2e-4 * force_range, 2 * force_range / levels, -force_range, force_range, cutoff, grade.filter_order, 0.3 * late,
        float(rng.normal(0, 2e-3)) * force_range, scale, grade.filter_shape,
    )  # fmt: skip
    return Rack(pressure(), pressure(), pressure(), position, force, grade.jitter)


def filtered(values: Array, channel: Channel, rate: float) -> Array:
    """Return a signal behind the channel's filter and delay, sampled as the input, shape (n,)."""
    out = values
    if channel.cutoff > 0.0:
        b, a = _filter(channel, min(channel.cutoff / (0.5 * rate), 0.95))
        # in the steady state of the first value
        out = out[0] + lfilter(b, a, out - out[0])
    if channel.delay > 0.0:
        index = np.arange(len(out)) - channel.delay * rate
        out = np.interp(index, np.arange(len(out)), out)
    return out


def shown(values: Array, channel: Channel, rng: np.random.Generator) -> Array:
    """Return what the channel shows of a filtered signal, shape (n,)."""
    seen = channel.scale * values + channel.offset + channel.noise * rng.standard_normal(len(values))
    seen = np.clip(seen, channel.low, channel.high)
    return np.round(seen / channel.step) * channel.step if channel.step > 0.0 else seen
