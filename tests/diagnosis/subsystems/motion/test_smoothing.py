"""The filter of a balance: it lets a constant pass, spans enough samples of any clock, and long recordings are thinned behind it."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import TIME
from numpy.typing import NDArray
from scipy import sparse

from exo_sim.diagnosis.subsystems.motion.smoothing import (
    FEWEST_IN_FILTER,
    MOST_SAMPLES,
    SMOOTHING,
    before_filter,
    on_clock,
    smoothed_alike,
    smoothed_on_clock,
    smoothing_width,
    stride,
    thinned,
)
from exo_sim.recording.filters import EvenClock


@pytest.mark.parametrize(("rate", "width"), [(1000.0, SMOOTHING), (100.0, FEWEST_IN_FILTER / 100.0)])
def test_the_width_is_a_time_until_a_slow_clock_asks_for_samples(rate: float, width: float) -> None:
    assert smoothing_width(np.arange(50) / rate) == pytest.approx(width)


def test_a_constant_passes_and_a_fast_wave_does_not() -> None:
    np.testing.assert_allclose(smoothed_alike(TIME, np.full(TIME.size, 3.0)), 3.0, rtol=1e-12)
    inner = slice(500, -500)
    assert np.std(smoothed_alike(TIME, np.sin(2.0 * np.pi * 100.0 * TIME))[inner]) < 1e-3
    slow = np.sin(2.0 * TIME)
    np.testing.assert_allclose(smoothed_alike(TIME, slow)[inner], slow[inner], atol=2e-3)


@pytest.mark.parametrize(("samples", "rate", "every"), [(1000, 1000.0, 1), (MOST_SAMPLES + 1, 1000.0, 2), (10 * MOST_SAMPLES, 1000.0, 5)])
def test_a_long_recording_keeps_every_so_many_samples_and_never_too_few_in_the_filter(samples: int, rate: float, every: int) -> None:
    assert stride(np.arange(samples) / rate) == every


def test_values_come_to_the_samples_that_were_kept() -> None:
    run = motion_runs.balance(np.zeros(TIME.size))
    values = np.cos(TIME)
    assert on_clock(run, TIME, values) is values
    assert thinned(values, 3).size == -(-TIME.size // 3)
    finer = np.linspace(TIME[0], TIME[-1], 4 * TIME.size)
    np.testing.assert_allclose(on_clock(run, finer, np.cos(finer)), values, atol=1e-6)
    np.testing.assert_allclose(smoothed_on_clock(run, TIME, values), smoothed_alike(TIME, values))


@pytest.mark.parametrize("uneven", [False, True])
@pytest.mark.parametrize("n", [40, 3000])
def test_weights_before_the_filter_take_what_they_take_behind_it(uneven: bool, n: int) -> None:
    chance = np.random.default_rng(n)
    time: NDArray[np.float64] = np.linspace(0.0, 1e-3 * (n - 1), n)
    if uneven:
        time = np.delete(time + 2e-4 * chance.random(n), [n // 3, n // 2])
    values, weights = chance.standard_normal(len(time)), sparse.csr_array(chance.random((7, len(time))))
    clock = EvenClock.of(time)
    assert (clock.even is not None) == uneven
    expected = weights @ smoothed_alike(time, values, clock)
    np.testing.assert_allclose(before_filter(weights, time, clock) @ values, expected, rtol=1e-10, atol=1e-10)
