"""Known noise on known motion: the floor must come back, whatever moves under it."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from exo_sim.recording import noise
from exo_sim.recording.table import Recording

RATE = 1000.0


def motion(n: int, dt: float = 1.0 / RATE) -> np.ndarray:
    """A pressure that swings and, every 1.6 s, jumps as after a valve."""
    time = np.arange(n) * dt
    jump = 5e4 * np.sign(np.sin(2 * np.pi * 0.31 * time)) * (1 - np.exp(-(time % 1.6) / 0.05))
    return 3e5 + 2e5 * np.sin(2 * np.pi * 0.7 * time) + jump


@settings(deadline=None, max_examples=25)
@given(std=st.floats(20.0, 5e3), seed=st.integers(0, 10**6), n=st.integers(3000, 20000))
def test_white_noise_comes_back_within_a_tenth(std: float, seed: int, n: int) -> None:
    values = motion(n) + std * np.random.default_rng(seed).standard_normal(n)
    found = noise.floor(values, np.arange(n) / RATE)
    assert found.std == pytest.approx(std, rel=0.1)
    assert found.step == 0.0
    assert found.signal_share < 0.1


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("step", [0.0, 1000.0])
def test_both_estimators_agree_where_all_noise_is_white(step: float, seed: int) -> None:
    values = motion(12000) + 800.0 * np.random.default_rng(seed).standard_normal(12000)
    if step:
        values = np.round(values / step) * step
    found = noise.white_noise(values)
    assert found == pytest.approx(noise.floor(values, np.arange(12000) / RATE).std, rel=0.08)
    assert found == pytest.approx(np.hypot(800.0, step / np.sqrt(12.0)), rel=0.08)


def test_of_correlated_noise_the_quick_estimate_sees_the_lesser_part() -> None:
    r = np.exp(-1.0 / 5.0)
    values = motion(24000) + 500.0 * lfilter([np.sqrt(1 - r * r)], [1.0, -r], np.random.default_rng(0).standard_normal(24500))[500:]
    assert noise.white_noise(values) < 0.5 * noise.floor(values, np.arange(24000) / RATE).std


def test_the_quick_estimate_of_few_or_resting_samples() -> None:
    assert noise.white_noise(None) == noise.white_noise(np.arange(19.0)) == noise.white_noise(np.full(100, 2.0)) == 0.0
    resting = np.full(1000, 2.0)
    resting[500] = 5.0
    assert noise.white_noise(resting) == pytest.approx(3.0 / np.sqrt(12.0))


@pytest.mark.parametrize("samples", [2.0, 5.0])
@pytest.mark.parametrize("seed", range(4))
def test_correlated_noise_is_not_taken_for_less(samples: float, seed: int) -> None:
    r = np.exp(-1.0 / samples)
    white = np.random.default_rng(seed).standard_normal(24500)
    values = motion(24000) + 500.0 * lfilter([np.sqrt(1 - r * r)], [1.0, -r], white)[500:]
    found = noise.floor(values, np.arange(24000) / RATE)
    assert found.std == pytest.approx(500.0, rel=0.2)
    assert found.correlation_time == pytest.approx(samples / RATE, rel=0.4)
    assert found.correlated > 0.8 * found.std


@settings(deadline=None, max_examples=25)
@given(ratio=st.floats(0.0, 2.0), seed=st.integers(0, 10**6))
def test_quantisation_is_found_and_added(ratio: float, seed: int) -> None:
    step = 1000.0
    smooth = motion(12000) + ratio * step * np.random.default_rng(seed).standard_normal(12000)
    found = noise.floor(np.round(smooth / step) * step, np.arange(12000) / RATE)
    assert found.step == pytest.approx(step)
    assert found.std == pytest.approx(step * np.sqrt(ratio**2 + 1 / 12), rel=0.25)


def test_a_step_survives_a_change_of_unit() -> None:
    counts = np.random.default_rng(0).integers(0, 4000, 5000).astype(float)
    assert noise.quantum(counts * 0.0254 * 0.01 + 1.7) == pytest.approx(0.000254)
    assert noise.quantum(np.random.default_rng(0).standard_normal(5000)) == 0.0
    assert noise.quantum(np.full(100, 3.0)) == 0.0
    assert noise.quantum(np.arange(5000, dtype=float) * 4e-7) == 0.0


def test_motion_without_noise_has_none_to_speak_of() -> None:
    assert noise.floor(motion(20000), np.arange(20000) / RATE).std < 1.0
    assert noise.floor(np.full(500, 2.0), np.arange(500) / RATE) == noise.Noise(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_too_slow_a_clock_is_admitted() -> None:
    found = noise.floor(motion(1000, 0.1), np.arange(1000, dtype=float) * 0.1)
    assert found.signal_share > 0.9


def test_gaps_and_holes_do_not_count() -> None:
    rng = np.random.default_rng(3)
    values = motion(20000) + 250.0 * rng.standard_normal(20000)
    values[4000:4300] = np.nan
    keep = np.ones(20000, bool)
    keep[9000:12000] = False
    keep[rng.random(20000) < 0.01] = False
    found = noise.floor(values[keep], (np.arange(20000) / RATE)[keep])
    assert found.std == pytest.approx(250.0, rel=0.1)


def test_all_columns_at_once() -> None:
    time = np.arange(5000, dtype=float) / RATE
    values = motion(5000) + 250.0 * np.random.default_rng(0).standard_normal(5000)
    recording = Recording("r", time, {"p.pressure_1": values, "p.valve_command": np.zeros(5000)}, {})
    found = noise.floors(recording)
    assert set(found) == {"p.pressure_1", "p.valve_command"}
    assert found["p.valve_command"].std == 0.0


def test_a_change_holds_what_noise_does_not_make_and_nothing_where_chance_may():
    assert noise.beyond_noise(25.0, 9.0, 200.0) == 4.0
    assert noise.beyond_noise(9.0 * 1.19, 9.0, 200.0) == 0.0  # two standard errors of a mean of 200 squares are a fifth
    assert noise.beyond_noise(9.0 * 1.21, 9.0, 200.0) > 0.0


def test_white_noise_by_pieces_is_that_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    values = motion(3000) + np.random.default_rng(4).standard_normal(3000)
    values[100:120] = np.nan
    fourth = np.diff(values[np.isfinite(values)], 4) / np.sqrt(70.0)
    monkeypatch.setattr(noise, "PIECE", 100)
    assert noise.white_noise(values) == 1.4826 * np.median(np.abs(fourth - np.median(fourth)))


def test_white_noise_of_a_long_column_takes_little_more_than_another() -> None:
    values = motion(1_000_000)
    tracemalloc.start()
    try:
        noise.white_noise(values)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 1.5 * values.nbytes


def test_finite_values_are_the_column_itself_where_all_are() -> None:
    values = np.arange(5.0)
    assert noise.finite(values) is values
    values = np.array([1.0, np.nan, np.inf, 2.0])
    np.testing.assert_array_equal(noise.finite(values), [1.0, 2.0])
