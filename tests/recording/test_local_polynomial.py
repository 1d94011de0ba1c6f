"""Local polynomials: what a polynomial says of itself, and the numbers of `scipy.signal`, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import savgol_coeffs, savgol_filter

from exo_sim.recording.local_polynomial import filtered, weights

STEP = 2.5e-3
NOISE = np.cumsum(np.random.default_rng(3).standard_normal(400))


@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_a_cubic_keeps_its_values_and_derivatives_up_to_its_ends(derivative: int) -> None:
    cubic = np.polynomial.Polynomial([0.3, -1.0, 4.0, 2.5])
    time = np.arange(200) * STEP
    wanted = cubic.deriv(derivative)(time) if derivative else cubic(time)
    np.testing.assert_allclose(filtered(cubic(time), 31, 3, derivative, STEP), wanted, rtol=1e-7, atol=1e-7)


def test_weights_of_a_mean_and_of_a_slope() -> None:
    np.testing.assert_allclose(weights(5, 1, at=2), np.full(5, 0.2))
    np.testing.assert_allclose(weights(3, 1, at=0, derivative=1, step=0.5), [-1.0, 0.0, 1.0], atol=1e-12)


@pytest.mark.parametrize("points", [5, 15, 101])
@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_the_numbers_are_those_of_scipy(points: int, derivative: int) -> None:
    for at in (0, points // 2):
        theirs = savgol_coeffs(points, 2, deriv=derivative, delta=STEP, pos=at, use="dot")
        np.testing.assert_array_equal(weights(points, 2, at, derivative, STEP), theirs)
    theirs = savgol_filter(NOISE, points, 3, deriv=derivative, delta=STEP, mode="interp")
    np.testing.assert_array_equal(filtered(NOISE, points, 3, derivative, STEP), theirs)
