"""How much less a row of a balance of forces weighs where a contact hardly slides.

At a few millimetres a second dry friction depends on what no position sensor resolves: how far bristles are bent, how a film builds up,
which of the two directions the last tenth of a millimetre went. What is left there by every law that is known is scatter of the contact,
and neither noise of a sensor nor a law of friction. It is estimated by speed and enters the standard deviation of the rows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from exo_sim.diagnosis.policy.healthy import CONTACT_SCATTER, CREEPING, SETTLED_SCATTER

Array = NDArray[np.float64]

#: Rows of a bin of speed, and the most bins.
FEWEST_IN_BIN, MOST_BINS = 25, 12


@dataclass(frozen=True)
class ContactScatter:
    """A factor on the standard deviation of rows that does not rise with speed.

    Attributes:
        speeds: Of the knots [m/s or rad/s], rising, shape (k,).
        factors: There, at least 1, shape (k,).
    """

    speeds: Array
    factors: Array

    def settles_at(self) -> float:
        """Return the speed above which the standard deviation is less than `SETTLED_SCATTER` times that of other rows."""
        scattered = self.speeds[self.factors > SETTLED_SCATTER]
        return float(scattered[-1]) if scattered.size else 0.0

    def at(self, speed: Array) -> Array:
        """Return the factor at speeds, shape of these."""
        return np.exp(np.interp(np.log(np.maximum(speed, 1e-12)), np.log(self.speeds), np.log(self.factors)))


def contact_scatter(left: Array, speed: Array) -> ContactScatter | None:
    """Return how much more is left at low speeds than at others; None where it is not plainly more.

    Args:
        left: What every law together leaves of each row, in units of its noise, shape (n,).
        speed: Of the rows, shape (n,).
    """
    count = min(len(left) // FEWEST_IN_BIN, MOST_BINS)
    if count < 3:
        return None
    order = np.argsort(speed, kind="stable")
    bins = np.array_split(order, count)
    middle = np.maximum(np.array([float(np.median(speed[one])) for one in bins]), 1e-12)
    squares = np.maximum([float(np.mean(left[one] ** 2)) for one in bins], 1e-12)
    usual = float(np.median(squares[count // 2 :]))
    falling = isotonic_regression(np.log(squares / usual), increasing=False).x
    creeping = middle < CREEPING * float(np.percentile(speed, 95.0))
    factors = np.where(creeping, np.exp(0.5 * np.maximum(falling, 0.0)), 1.0)
    if factors[0] < CONTACT_SCATTER or not (np.diff(middle) > 0.0).all():
        return None
    return ContactScatter(middle, factors)


def friction_of_noise(friction: float, speed: Array, noise: Array, creep: float) -> Array:
    """Return what noise of the velocity leaves of friction that builds up as tanh(v/creep), standard deviation by row, shape (n,).

    Args:
        friction: Its size [N or N m].
        speed, noise: Of the rows, and of their velocity [m/s or rad/s], shape (n,).
        creep: The speed at which it has built up [m/s or rad/s].
    """
    return friction / creep / np.cosh(np.minimum(speed / creep, 50.0)) ** 2 * noise
