"""The error process whitens what it describes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.estimation.noise_model import noise_model

BLOCKS = np.repeat(np.arange(10), 500)
WHITE = np.random.default_rng(4).standard_normal(BLOCKS.size)


def test_white_noise_stays_as_it_is() -> None:
    found = noise_model(WHITE, BLOCKS)
    assert found.innovation == pytest.approx(1.0, abs=0.05)
    assert np.corrcoef(found.whitened(WHITE), WHITE)[0, 1] > 0.99


@pytest.mark.parametrize("phi", [0.5, 0.9, 0.975])
def test_a_markov_process_beneath_noise_becomes_white(phi: float) -> None:
    slow = lfilter([1.0], [1.0, -phi], 0.5 * np.random.default_rng(5).standard_normal(BLOCKS.size))
    both = slow + WHITE
    found = noise_model(both, BLOCKS)
    rows = found.whitened(both)
    assert rows.std() == pytest.approx(1.0, abs=0.03)
    assert correlation_time(rows, BLOCKS) < 1.2 < correlation_time(both, BLOCKS)


def test_columns_are_whitened_like_the_residual_each() -> None:
    found = noise_model(np.cumsum(WHITE) * 0.1 + WHITE, BLOCKS)
    pair = np.column_stack([WHITE, -2.0 * WHITE])
    assert np.allclose(found.whitened(pair)[:, 1], -2.0 * found.whitened(WHITE))
