"""Filters: what they take of a signal, what they leave of its noise, and that a law asked behind them is the law that acted."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.recording import filters
from exo_sim.recording.filters import (
    QUICKER,
    RESTORED,
    SMOOTHED,
    EvenClock,
    gaussian_derivatives,
    gaussian_smoothed,
    gaussian_width,
    noise_gain,
    restored,
    smoothed_motion,
)

STEP, SECONDS = 1e-3, 0.031
TIME = np.arange(6000, dtype=float) * STEP
INSIDE = slice(200, -200)


@given(st.floats(0.5, 12.0))
def test_what_the_filter_took_is_put_back_but_for_its_square(frequency: float) -> None:
    wave = np.sin(2.0 * np.pi * frequency * TIME)
    kept = np.exp(-0.5 * (2.0 * np.pi * frequency * gaussian_width(SECONDS)) ** 2)
    smooth = gaussian_smoothed(TIME, wave, SECONDS)
    np.testing.assert_allclose(smooth[INSIDE], kept * wave[INSIDE], atol=2e-4)
    np.testing.assert_allclose(restored(TIME, smooth, SECONDS)[INSIDE], (1.0 - (1.0 - kept) ** 2) * wave[INSIDE], atol=4e-4)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("name", ["gaussian_derivatives", "restored"])
def test_what_is_left_of_white_noise(order: int, name: str) -> None:
    noise = np.random.default_rng(5).standard_normal(400_000)
    time = np.arange(noise.size, dtype=float) * STEP
    left = gaussian_derivatives(time, noise, SECONDS)[order]
    if name == "restored":
        left = restored(time, left, SECONDS)
    said = noise_gain(order, SECONDS, STEP, RESTORED if name == "restored" else SMOOTHED)
    assert np.std(left[INSIDE]) == pytest.approx(said, rel=0.03)


@pytest.mark.parametrize("step", [1e-3, 5e-3, 10e-3, 20e-3])
def test_a_slow_clock_takes_little_from_a_velocity(step: float) -> None:
    time = np.arange(3000, dtype=float) * step
    seconds, turn = max(SECONDS, 6.0 * step), 2.0 * np.pi * min(5.0, 0.03 / step)
    velocity = smoothed_motion(time, np.sin(turn * time), seconds, noise=0.0).velocity[INSIDE] / turn
    np.testing.assert_allclose(velocity, np.cos(turn * time)[INSIDE], atol=2e-3)


def test_gaps_and_rest_are_no_trouble() -> None:
    position = np.sin(2.0 * np.pi * TIME)
    position[3000:3010] = np.nan
    found = smoothed_motion(TIME, position, SECONDS)
    assert np.isfinite(found.velocity).all()
    np.testing.assert_allclose(found.velocity[INSIDE], 2.0 * np.pi * np.cos(2.0 * np.pi * TIME)[INSIDE], atol=0.02)
    still = smoothed_motion(TIME, np.full(TIME.size, 0.3), SECONDS)
    assert np.all(still.velocity == 0.0) and still.velocity_noise == 0.0


@pytest.mark.parametrize("frequency", [1.0, 3.0, 5.0])
def test_drag_of_a_measured_motion_is_the_drag_that_acted(frequency: float) -> None:
    turn = 2.0 * np.pi * frequency
    position = 0.05 * np.sin(turn * TIME) + 1e-6 * np.random.default_rng(1).standard_normal(TIME.size)
    velocity = 0.05 * turn * np.cos(turn * TIME)
    felt = gaussian_smoothed(TIME, velocity * np.abs(velocity), SECONDS)[INSIDE]
    restored_, plain = smoothed_motion(TIME, position, SECONDS).velocity, gaussian_derivatives(TIME, position, SECONDS)[1]
    drags = [gaussian_smoothed(TIME, v * np.abs(v), SECONDS)[INSIDE] for v in (plain, restored_)]
    worse, off = (abs(float(felt @ drag) / float(felt @ felt) - 1.0) for drag in drags)
    assert off < 1e-3
    assert worse > (2.0 * np.pi * frequency * gaussian_width(SECONDS)) ** 2 / 1.5  # the bias that is put right


@pytest.mark.parametrize(("jitter", "width"), [(1e-6, QUICKER * SECONDS), (3e-4, SECONDS)])
def test_noise_decides_how_quick_the_velocity_is(jitter: float, width: float) -> None:
    position = 0.05 * np.sin(2.0 * np.pi * TIME) + jitter * np.random.default_rng(1).standard_normal(TIME.size)
    found = smoothed_motion(TIME, position, SECONDS)
    assert found.position_noise == pytest.approx(jitter, rel=0.1)
    assert found.velocity_noise == pytest.approx(found.position_noise * noise_gain(1, width, STEP, RESTORED))
    np.testing.assert_array_equal(found.acceleration, gaussian_derivatives(TIME, position, SECONDS)[2])


def most_at_once(work: Callable[[], object]) -> float:
    """Return how many bytes were held at most beyond those that were held before."""
    tracemalloc.start()
    try:
        work()
        return float(tracemalloc.get_traced_memory()[1])
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("count", [3, 5, 6, 29, 400])
def test_derivatives_taken_piece_by_piece_are_those_of_the_whole(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    time = np.arange(count, dtype=float) * STEP
    values = np.random.default_rng(count).standard_normal(count)
    whole = gaussian_derivatives(time, values, 0.006)
    quiet = whole[0]
    rate, bend = np.gradient(quiet, STEP), np.zeros(count)
    np.testing.assert_allclose(whole[1][[0, -1]], rate[[0, -1]], rtol=1e-9)
    bend[1:-1] = (quiet[2:] - 2.0 * quiet[1:-1] + quiet[:-2]) / STEP**2
    near = [1, -2] if count > 4 else slice(None)
    np.testing.assert_allclose(whole[2][near], bend[near], rtol=1e-6)
    monkeypatch.setattr(filters, "PIECE", 7)
    for one, other in zip(gaussian_derivatives(time, values, 0.006), whole, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("late", [0.0, 0.01, 0.03, 5.0])
def test_a_clock_is_even_as_far_as_its_worst_sample(late: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(filters, "PIECE", 7)
    time = 3.0 + np.arange(50, dtype=float) * 0.01
    time[40:] += 0.01 * late
    grid = np.arange(time[0], time[-1] + 0.005, 0.01)
    found = EvenClock.of(time)
    assert (found.even is None) == (len(grid) == len(time) and np.allclose(grid, time, atol=2e-4))
    if found.even is not None:
        np.testing.assert_allclose(found.even, grid)


def test_a_long_position_is_smoothed_in_a_few_columns_of_memory() -> None:
    time = np.arange(1_000_000, dtype=float) * STEP
    position = np.sin(time)
    assert most_at_once(lambda: smoothed_motion(time, position, SECONDS, 0.0)) < 6.5 * position.nbytes
