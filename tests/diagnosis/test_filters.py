"""Filters: what they take of a signal, what they leave of its noise, and that a law asked behind them is the law that acted."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.filters import LED, QUICKER, RESTORED, gaussian_width, led, left_of_noise, moved, quieted, restored

STEP, SECONDS = 1e-3, 0.031
TIME = np.arange(6000) * STEP
INSIDE = slice(200, -200)


@given(st.floats(0.5, 12.0))
def test_what_the_filter_took_is_put_back_but_for_its_square(frequency: float) -> None:
    wave = np.sin(2.0 * np.pi * frequency * TIME)
    kept = np.exp(-0.5 * (2.0 * np.pi * frequency * gaussian_width(SECONDS)) ** 2)
    smooth = quieted(TIME, wave, SECONDS)
    np.testing.assert_allclose(smooth[INSIDE], kept * wave[INSIDE], atol=2e-4)
    np.testing.assert_allclose(restored(TIME, smooth, SECONDS)[INSIDE], (1.0 - (1.0 - kept) ** 2) * wave[INSIDE], atol=4e-4)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("name", ["led", "restored"])
def test_what_is_left_of_white_noise(order: int, name: str) -> None:
    noise = np.random.default_rng(5).standard_normal(400_000)
    time = np.arange(noise.size) * STEP
    left = led(time, noise, SECONDS)[order]
    if name == "restored":
        left = restored(time, left, SECONDS)
    said = left_of_noise(order, SECONDS, STEP, RESTORED if name == "restored" else LED)
    assert np.std(left[INSIDE]) == pytest.approx(said, rel=0.03)


@pytest.mark.parametrize("step", [1e-3, 5e-3, 10e-3, 20e-3])
def test_a_slow_clock_takes_little_from_a_velocity(step: float) -> None:
    time = np.arange(3000) * step
    seconds, turn = max(SECONDS, 6.0 * step), 2.0 * np.pi * min(5.0, 0.03 / step)
    velocity = moved(time, np.sin(turn * time), seconds, jitter=0.0).velocity[INSIDE] / turn
    np.testing.assert_allclose(velocity, np.cos(turn * time)[INSIDE], atol=2e-3)


def test_gaps_and_rest_are_no_trouble() -> None:
    position = np.sin(2.0 * np.pi * TIME)
    position[3000:3010] = np.nan
    found = moved(TIME, position, SECONDS)
    assert np.isfinite(found.velocity).all()
    np.testing.assert_allclose(found.velocity[INSIDE], 2.0 * np.pi * np.cos(2.0 * np.pi * TIME)[INSIDE], atol=0.02)
    still = moved(TIME, np.full(TIME.size, 0.3), SECONDS)
    assert np.all(still.velocity == 0.0) and still.shake == 0.0


@pytest.mark.parametrize("frequency", [1.0, 3.0, 5.0])
def test_drag_of_a_measured_motion_is_the_drag_that_acted(frequency: float) -> None:
    turn = 2.0 * np.pi * frequency
    position = 0.05 * np.sin(turn * TIME) + 1e-6 * np.random.default_rng(1).standard_normal(TIME.size)
    velocity = 0.05 * turn * np.cos(turn * TIME)
    felt = quieted(TIME, velocity * np.abs(velocity), SECONDS)[INSIDE]
    by = {name: quieted(TIME, v * np.abs(v), SECONDS)[INSIDE] for name, v in (
        ("moved", moved(TIME, position, SECONDS).velocity), ("led", led(TIME, position, SECONDS)[1]))}  # fmt: skip
    worse, off = (abs(float(felt @ by[name]) / float(felt @ felt) - 1.0) for name in ("led", "moved"))
    assert off < 1e-3
    assert worse > (2.0 * np.pi * frequency * gaussian_width(SECONDS)) ** 2 / 1.5  # the bias that is put right


@pytest.mark.parametrize(("jitter", "width"), [(1e-6, QUICKER * SECONDS), (3e-4, SECONDS)])
def test_noise_decides_how_quick_the_velocity_is(jitter: float, width: float) -> None:
    position = 0.05 * np.sin(2.0 * np.pi * TIME) + jitter * np.random.default_rng(1).standard_normal(TIME.size)
    found = moved(TIME, position, SECONDS)
    assert found.jitter == pytest.approx(jitter, rel=0.1)
    assert found.shake == pytest.approx(found.jitter * left_of_noise(1, width, STEP, RESTORED))
    np.testing.assert_array_equal(found.acceleration, led(TIME, position, SECONDS)[2])
