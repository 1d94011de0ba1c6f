"""Evidence: correlated errors count once; less than the noise is no gain."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.policy.acceptance import (
    BEYOND_DOUBT_ODDS,
    BEYOND_DOUBT_SHARE,
    BEYOND_DOUBT_VARIANCE,
    RELIEF,
    UNDERRATED,
)
from exo_sim.diagnosis.selection.evidence import (
    compare,
    could_any_be_accepted,
    could_be_accepted,
    is_accepted,
    misfit,
    negative_log_likelihood,
)

BLOCKS = np.repeat(np.arange(20), 200)


class Rows:
    def __init__(self, blocks: np.ndarray):
        self.blocks = blocks
        self.size = blocks.size


def fit_of(residual: np.ndarray, penalty: float = 0.0) -> Fit:
    return Fit((), {}, residual, np.zeros((residual.size, 0)), penalty)


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_misfit_grows_with_the_variance(one: float, other: float) -> None:
    low, high = sorted((one, other))
    assert misfit(low) <= misfit(high)
    assert misfit(low) < misfit(high) or high < (1.0 + 1e-9) * low  # numbers next to each other may round to the same


def test_less_than_the_noise_is_hardly_a_gain() -> None:
    rng = np.random.default_rng(2)
    quiet = 0.2 * rng.standard_normal(BLOCKS.size)
    assert negative_log_likelihood(fit_of(quiet), 1000.0) - negative_log_likelihood(fit_of(0.5 * quiet), 1000.0) < 0.5 * 1000.0 * 0.04


def test_a_false_effect_does_not_pass_and_a_true_one_does() -> None:
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(BLOCKS.size)
    start = fit_of(noise + 3.0 * np.sin(np.arange(BLOCKS.size) / 7.0))
    true, false = fit_of(noise), fit_of(0.999 * start.residual)
    rows = Rows(BLOCKS)
    assert is_accepted(compare(rows, start, true, 1, 30), start, start, true, 0.0)
    assert not is_accepted(compare(rows, start, false, 1, 30), start, start, false, 0.0)


def test_a_small_error_is_a_finding_only_beyond_doubt() -> None:
    rng = np.random.default_rng(3)
    noise, wave = rng.standard_normal(BLOCKS.size), np.sin(np.arange(BLOCKS.size) / 7.0)
    rows, true = Rows(BLOCKS), fit_of(noise)
    for size, plain in ((3.0, True), (0.35, False)):
        start = fit_of(noise + size * wave)
        weighing = compare(rows, start, true, 1, 30)
        assert (weighing.log10_odds > BEYOND_DOUBT_ODDS) == plain
        assert is_accepted(weighing, start, start, true, 0.0)
        assert is_accepted(weighing, start, start, true, 10.0) == plain


def test_below_the_noise_nothing_is_gained_whatever_its_odds() -> None:
    rng = np.random.default_rng(3)
    quiet = 0.5 * rng.standard_normal(60 * BLOCKS.size)
    rows = Rows(np.arange(quiet.size) // 50)
    start, less = fit_of(quiet + 0.25 * np.sin(np.arange(quiet.size) / 7.0)), fit_of(quiet)
    weighing = compare(rows, start, less, 1, 30)
    assert weighing.log10_odds > BEYOND_DOUBT_ODDS and weighing.share == 1.0
    assert not is_accepted(weighing, start, start, less, 0.0)
    before, after = (fit_of(2.5 * one.residual) for one in (start, less))
    assert is_accepted(compare(rows, before, after, 1, 30), before, before, after, 0.0)


def test_great_odds_for_a_small_share_are_not_beyond_doubt() -> None:
    rng = np.random.default_rng(3)
    noise, wave = rng.standard_normal(60 * BLOCKS.size), np.sin(np.arange(60 * BLOCKS.size) / 7.0)
    rows = Rows(np.arange(noise.size) // 50)
    start, less = fit_of(noise + 3.0 * wave), fit_of(noise + 2.5 * wave)
    weighing = compare(rows, start, less, 1, 30)
    assert weighing.share < BEYOND_DOUBT_SHARE
    assert not is_accepted(weighing, start, start, less, 10.0)


@pytest.mark.parametrize(
    ("penalty", "size", "accepted"),
    [(RELIEF + 1.0, 0.35, True), (RELIEF - 1.0, 0.35, False), (RELIEF + 1.0, 0.02, False)],
    ids=["hidden by numbers", "hardly", "no shape"],
)
def test_a_small_shape_that_returns_the_numbers_of_a_rig_to_their_data_sheets_counts(penalty: float, size: float, accepted: bool) -> None:
    rng = np.random.default_rng(3)
    noise, wave = 0.9 * rng.standard_normal(BLOCKS.size), np.sin(np.arange(BLOCKS.size) / 7.0)
    rows, strained, true = Rows(BLOCKS), fit_of(noise + size * wave, 20.0 + penalty), fit_of(noise, 20.0)
    assert is_accepted(compare(rows, strained, true, 1, 30), strained, strained, true, 10.0) is accepted


def test_what_relieves_numbers_in_one_block_alone_is_not_accepted_for_that() -> None:
    rng = np.random.default_rng(3)
    noise = 0.9 * rng.standard_normal(BLOCKS.size)
    burst = np.where(BLOCKS == 7, 1.5 * np.sin(np.arange(BLOCKS.size) / 7.0), 0.0)
    strained, less = fit_of(noise + burst, 30.0), fit_of(noise, 10.0)
    assert not is_accepted(compare(Rows(BLOCKS), strained, less, 1, 30), strained, strained, less, 10.0)


@pytest.mark.parametrize("steady", [True, False])
def test_an_error_hardly_above_the_noise_is_a_finding_where_it_has_a_shape_of_its_own_all_the_time(steady: bool) -> None:
    rng = np.random.default_rng(3)
    rows = Rows(np.arange(60 * BLOCKS.size) // (3 * BLOCKS.size))
    noise, wave = rng.standard_normal(rows.size), np.sin(np.arange(rows.size) / 7.0)
    size = 0.45 if steady else np.where(rows.blocks == 7, 0.45 * np.sqrt(20.0), 0.0)  # as much in one block
    start, less = fit_of(noise + size * wave), fit_of(noise)
    assert start.sse < BEYOND_DOUBT_VARIANCE * rows.size
    weighing = compare(rows, start, less, 1, 30)
    assert weighing.log10_odds > BEYOND_DOUBT_ODDS and weighing.share > BEYOND_DOUBT_SHARE
    assert is_accepted(weighing, start, start, less, 10.0) is steady


@given(st.floats(0.3, 100.0), st.floats(0.0, 1.0), st.floats(0.0, 3.0))
def test_whatever_passes_was_promised(variance: float, kept: float, material: float) -> None:
    noise = np.random.default_rng(3).standard_normal(BLOCKS.size)
    start = fit_of(np.sqrt(variance) * noise)
    end = fit_of(np.sqrt(kept * variance) * noise)
    fallen = start.sse - end.sse
    if is_accepted(compare(Rows(BLOCKS), start, end, 1, 30), start, start, end, material):
        assert could_be_accepted(1.001 * fallen / UNDERRATED, start, material)


def test_at_the_noise_nothing_small_is_promised() -> None:
    noise = fit_of(np.random.default_rng(3).standard_normal(BLOCKS.size))
    assert not could_be_accepted(20.0, noise, 0.3)
    assert could_be_accepted(0.5 * noise.sse, noise, 0.3)


def test_white_noise_that_is_too_small_to_matter_is_not_asked_for_its_cause() -> None:
    noise = 0.9 * np.random.default_rng(2).standard_normal(BLOCKS.size)
    assert not could_any_be_accepted(fit_of(noise), 0.5)
    assert could_any_be_accepted(fit_of(noise), 0.2)  # in a quieter machine so much would matter


def test_errors_that_hold_together_are_asked_however_small() -> None:
    slow = 1.2 * np.sin(np.linspace(0.0, 60.0, BLOCKS.size)) + 0.1 * np.random.default_rng(2).standard_normal(BLOCKS.size)
    assert could_any_be_accepted(fit_of(slow), 0.5)


def test_bursts_are_no_noise() -> None:
    residual = 0.3 * np.random.default_rng(2).standard_normal(BLOCKS.size)
    residual[::20] += 4.0  # what a valve that opens late leaves
    assert could_any_be_accepted(fit_of(residual), 0.5)


def test_more_than_the_noise_is_always_asked() -> None:
    assert could_any_be_accepted(fit_of(2.0 * np.random.default_rng(2).standard_normal(BLOCKS.size)), 5.0)
