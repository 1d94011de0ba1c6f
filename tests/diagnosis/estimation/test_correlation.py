"""Correlation of residuals: the integrated autocorrelation time of processes whose own is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.correlation import correlation_time, rms

BLOCKS = np.repeat(np.arange(20), 200)


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8, 0.95])
def test_correlation_time_of_an_autoregression(rho: float) -> None:
    rng = np.random.default_rng(1)
    noise = rng.standard_normal(BLOCKS.size)
    values = np.empty_like(noise)
    values[0] = noise[0]
    for i in range(1, noise.size):
        values[i] = rho * values[i - 1] + noise[i]
    exact = (1.0 + rho) / (1.0 - rho)
    assert correlation_time(values, BLOCKS) == pytest.approx(exact, rel=0.35)


def test_a_constant_error_counts_once_a_block() -> None:
    assert correlation_time(np.ones(BLOCKS.size), BLOCKS) > 100.0


def test_rows_of_different_blocks_are_no_neighbours() -> None:
    signs = np.where(np.arange(4000) % 2, 1.0, -1.0)  # of blocks of one row each
    assert correlation_time(np.abs(signs), np.arange(4000)) == 1.0


def test_no_error_has_no_correlation() -> None:
    assert correlation_time(np.zeros(100), np.zeros(100, dtype=np.int64)) == 1.0


def test_the_root_mean_square_is_of_what_is_finite() -> None:
    assert rms(np.array([3.0, np.nan, -4.0, np.inf])) == pytest.approx(math.sqrt(12.5))
    assert math.isnan(rms(np.array([np.nan])))
