"""What a force loop goes by: what is, or what gauges and encoders of a real machine show.

A machine has a pressure gauge at each chamber and an encoder at each joint. Nothing measures the temperature of the gas, so that a law
that needs it takes that of the supply. The speed of a piston is the difference of what the encoder shows, smoothed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.compiled import kernel

#: What force loops go by.
SIGNALS = ("exact", "measured")
#: Encoders of 14 bits a turn [rad].
ENCODER = 2.0 * np.pi / 2**14
#: Standard deviation of a pressure gauge's noise: 0.05 % of a span of 20 bar [Pa].
PRESSURE = 1e3
#: Time constant of the first-order filter behind the difference quotient of an encoder [s].
SMOOTHING = 5e-3
#: Samples of noise, which then come again: a prime number, so that no rhythm of a stride meets them.
_SAMPLES = 8191


class Gauges(NamedTuple):
    """Gauges and encoders of n cylinders.

    Attributes:
        noise: Of the gauges at chambers 1, then chambers 2 [Pa], shape (samples, 2 n); no rows where loops go by what is.
        place: Where the encoders showed each piston a step ago [m]; not a number before the first, shape (n,).
        speed: Its smoothed rate [m/s], shape (n,).
    """

    noise: NDArray[np.float64]
    place: NDArray[np.float64]
    speed: NDArray[np.float64]


def gauges(count: int, signals: str, seed: int = 0) -> Gauges:
    """Return the gauges of some cylinders, "exact" or "measured"."""
    rows = _SAMPLES if signals == "measured" else 0
    noise = PRESSURE * np.random.default_rng(seed).standard_normal((rows, 2 * count))
    return Gauges(noise, np.full(count, np.nan), np.zeros(count))


@kernel
def seen(i, step, dt, angle, arm, x, p_1, p_2, gauges):
    """Return pressures [Pa], place [m] and speed [m/s] of piston i as gauges and encoders show them, and remember the place.

    Args:
        i: Which cylinder.
        step: Of the run, the first is 0.
        dt: Its length [s].
        angle: Of the joint that it drives [rad].
        arm: Rate of its length by that angle [m/rad].
        x: Where its piston is [m].
        p_1, p_2: Pressures that its gauges read without noise [Pa].
        gauges: Its `place` and `speed` are written.
    """
    row = step % gauges.noise.shape[0]
    shown = x + arm * (ENCODER * np.rint(angle / ENCODER) - angle)
    if gauges.place[i] == gauges.place[i]:  # else it is the first time
        gauges.speed[i] += dt / (SMOOTHING + dt) * ((shown - gauges.place[i]) / dt - gauges.speed[i])
    gauges.place[i] = shown
    return p_1 + gauges.noise[row, i], p_2 + gauges.noise[row, gauges.place.size + i], shown, gauges.speed[i]
