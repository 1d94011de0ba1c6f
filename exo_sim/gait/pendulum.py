"""How the body sways above the feet that carry it: a linear inverted pendulum, solved for a cycle that comes again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.anthropometry import GRAVITY


def above(centre: NDArray[np.float64], height: float, period: float) -> NDArray[np.float64]:
    """Return where the mass is so that its weight and inertia pass through a centre of pressure: x - (height / g) x'' = centre.

    Args:
        centre: Of pressure over a cycle, without a steady advance [m], shape (n,).
        height: Of the mass above the ground [m].
        period: Of the cycle [s].
    """
    spectrum = np.fft.rfft(centre)
    rate = 2.0 * np.pi * np.arange(len(spectrum)) / period
    return np.fft.irfft(spectrum / (1.0 + height / GRAVITY * rate**2), len(centre))
