"""Weighing: errors that come in spells count once; less than the noise is no gain."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.fitting import Fit
from exo_sim.diagnosis.weighing import GREAT_ODDS, LARGER_SHARE, UNDERRATED, correlation_time, loss, misfit, passes, promises, weigh

BLOCKS = np.repeat(np.arange(20), 200)


class Rows:
    def __init__(self, blocks: np.ndarray):
        self.blocks = blocks
        self.size = blocks.size


def fit_of(residual: np.ndarray, penalty: float = 0.0) -> Fit:
    return Fit((), {}, residual, np.zeros((residual.size, 0)), penalty)


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


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_misfit_grows_with_the_variance(one: float, other: float) -> None:
    assert (misfit(one) <= misfit(other)) == (one <= other)


def test_less_than_the_noise_is_hardly_a_gain() -> None:
    rng = np.random.default_rng(2)
    quiet = 0.2 * rng.standard_normal(BLOCKS.size)
    assert loss(fit_of(quiet), 1000.0) - loss(fit_of(0.5 * quiet), 1000.0) < 0.5 * 1000.0 * 0.04


def test_a_false_effect_does_not_pass_and_a_true_one_does() -> None:
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(BLOCKS.size)
    start = fit_of(noise + 3.0 * np.sin(np.arange(BLOCKS.size) / 7.0))
    true, false = fit_of(noise), fit_of(0.999 * start.residual)
    rows = Rows(BLOCKS)
    assert passes(weigh(rows, start, true, 1, 30), start, start, true, 0.0)
    assert not passes(weigh(rows, start, false, 1, 30), start, start, false, 0.0)


def test_a_small_error_is_a_finding_only_beyond_doubt() -> None:
    rng = np.random.default_rng(3)
    noise, wave = rng.standard_normal(BLOCKS.size), np.sin(np.arange(BLOCKS.size) / 7.0)
    rows, true = Rows(BLOCKS), fit_of(noise)
    for size, plain in ((3.0, True), (0.35, False)):
        start = fit_of(noise + size * wave)
        weighing = weigh(rows, start, true, 1, 30)
        assert (weighing.log10_odds > GREAT_ODDS) == plain
        assert passes(weighing, start, start, true, 0.0)
        assert passes(weighing, start, start, true, 10.0) == plain


def test_below_the_noise_nothing_is_beyond_doubt() -> None:
    rng = np.random.default_rng(3)
    quiet = 0.5 * rng.standard_normal(60 * BLOCKS.size)
    rows = Rows(np.arange(quiet.size) // 50)
    start, less = fit_of(quiet + 0.25 * np.sin(np.arange(quiet.size) / 7.0)), fit_of(quiet)
    weighing = weigh(rows, start, less, 1, 30)
    assert weighing.log10_odds > GREAT_ODDS and weighing.share == 1.0
    assert not passes(weighing, start, start, less, 10.0)


def test_great_odds_for_a_small_share_are_not_beyond_doubt() -> None:
    rng = np.random.default_rng(3)
    noise, wave = rng.standard_normal(60 * BLOCKS.size), np.sin(np.arange(60 * BLOCKS.size) / 7.0)
    rows = Rows(np.arange(noise.size) // 50)
    start, less = fit_of(noise + 3.0 * wave), fit_of(noise + 2.5 * wave)
    weighing = weigh(rows, start, less, 1, 30)
    assert weighing.share < LARGER_SHARE
    assert not passes(weighing, start, start, less, 10.0)


@given(st.floats(0.3, 100.0), st.floats(0.0, 1.0), st.floats(0.0, 3.0))
def test_whatever_passes_was_promised(variance: float, kept: float, material: float) -> None:
    noise = np.random.default_rng(3).standard_normal(BLOCKS.size)
    start = fit_of(np.sqrt(variance) * noise)
    end = fit_of(np.sqrt(kept * variance) * noise)
    fallen = start.sse - end.sse
    if passes(weigh(Rows(BLOCKS), start, end, 1, 30), start, start, end, material):
        assert promises(1.001 * fallen / UNDERRATED, start, material)


def test_at_the_noise_nothing_small_is_promised() -> None:
    noise = fit_of(np.random.default_rng(3).standard_normal(BLOCKS.size))
    assert not promises(20.0, noise, 0.3)
    assert promises(0.5 * noise.sse, noise, 0.3)
