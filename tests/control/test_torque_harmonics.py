"""Harmonics of joint torques: what they are at a phase, how they are found, and the same torques later."""

import numpy as np
import pytest

from exo_sim.control.torque_harmonics import basis, basis_at, delayed, fitted

HARMONICS, COUNT = 3, 64


@pytest.fixture
def coefficients() -> np.ndarray:
    """Of two joints."""
    return np.random.default_rng(1).normal(size=2 * (2 * HARMONICS + 1))


def torques(coefficients: np.ndarray) -> np.ndarray:
    return np.asarray(basis(COUNT, HARMONICS) @ coefficients.reshape(2, -1).T)


def test_a_constant_then_cosine_and_sine_of_each_harmonic() -> None:
    row = basis_at(np.array([0.125]), 2)[0]
    np.testing.assert_allclose(row, [1.0, np.sqrt(0.5), np.sqrt(0.5), 0.0, 1.0], atol=1e-12)
    np.testing.assert_array_equal(basis(COUNT, HARMONICS), basis_at(np.arange(COUNT) / COUNT, HARMONICS))


def test_torques_of_harmonics_are_found_again(coefficients: np.ndarray) -> None:
    np.testing.assert_allclose(fitted(torques(coefficients), HARMONICS), coefficients)


def test_what_comes_later_is_shifted_and_nothing_else(coefficients: np.ndarray) -> None:
    np.testing.assert_allclose(torques(delayed(coefficients, 2, 5 / COUNT)), np.roll(torques(coefficients), 5, axis=0))
