"""A vessel held under pressure and then shut: the moment is found from its fall, and where nothing held it nothing is cut."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import cylinder_runs
from hypothesis import given, settings
from hypothesis import strategies as st

from exo_sim.diagnosis.data.decay_onset import from_decay_onset

N = 3000
HIGH, LOW = 6e5, 1e5
#: Noise as a share of the fall, and what random numbers it is made of.
NOISE = st.tuples(st.floats(0.0, 0.008), st.integers(0, 50))


def held_then_falling(held: int, tau: float, share: float = 0.0, seed: int = 0) -> tuple[np.ndarray, float]:
    """Return a pressure that holds for `held` samples, then falls with `tau` samples, and its noise [Pa]."""
    clean = LOW + (HIGH - LOW) * np.exp(-np.maximum(np.arange(N) - held, 0) / tau)
    noise = share * (clean[0] - clean[-1])
    return clean + noise * np.random.default_rng(seed).standard_normal(N), noise


@given(held=st.integers(200, 1200), tau=st.floats(30.0, 600.0), noise=NOISE, side=st.integers(0, 1))
@settings(max_examples=60)
def test_it_begins_where_the_pressure_was_let_go(held: int, tau: float, noise: tuple[float, int], side: int) -> None:
    pressure, jitter = held_then_falling(held, tau, *noise)
    sides = (pressure, None) if side == 0 else (None, pressure)
    levels = (jitter, 0.0) if side == 0 else (0.0, jitter)
    run = cylinder_runs.run_of(*sides, noise=levels)
    late = from_decay_onset(run)
    start = N - len(late.time)
    lost = -np.log(1.0 - 0.01 - 5.0 * noise[0])  # until the fall stands out of a hundredth of it and the noise
    # what precedes is held, what is lost of the fall is no more than the noise hides
    assert held - 12 <= start <= held + lost * tau + 2
    assert late.time[0] == run.time[start] and late.pressure[side] is not None
    np.testing.assert_array_equal(late.pressure[side], pressure[start:])


@given(tau=st.floats(30.0, 3e4), noise=NOISE)
@settings(max_examples=60)
def test_a_fall_from_the_first_sample_on_is_left_whole(tau: float, noise: tuple[float, int]) -> None:
    pressure, jitter = held_then_falling(0, tau, *noise)
    run = cylinder_runs.run_of(pressure, noise=(jitter, 0.0))
    assert from_decay_onset(run) is run


@given(level=st.floats(5e4, 9e5), jitter=st.floats(0.0, 3e3), seed=st.integers(0, 50))
def test_a_pressure_that_stays_is_left_whole(level: float, jitter: float, seed: int) -> None:
    pressure = level + jitter * np.random.default_rng(seed).standard_normal(N)
    run = cylinder_runs.run_of(pressure, noise=(jitter, 0.0))
    assert from_decay_onset(run) is run


def test_a_pressure_that_rises_is_left_whole() -> None:
    pressure, _ = held_then_falling(500, 100.0)
    run = cylinder_runs.run_of(HIGH + LOW - pressure)
    assert from_decay_onset(run) is run


def test_a_fall_lost_in_the_noise_tells_no_moment() -> None:
    pressure, _ = held_then_falling(500, 100.0)
    fall = pressure[0] - pressure[-1]
    assert len(from_decay_onset(cylinder_runs.run_of(pressure, noise=(fall / 120.0, 0.0))).time) < N
    run = cylinder_runs.run_of(pressure, noise=(fall / 80.0, 0.0))
    assert from_decay_onset(run) is run


@pytest.mark.parametrize("missing", [slice(0, 40), slice(480, 520), slice(2960, 3000)], ids=["first", "at the fall", "last"])
def test_missing_samples_hide_no_more_than_themselves(missing: slice) -> None:
    pressure, _ = held_then_falling(500, 100.0)
    pressure[missing] = np.nan
    start = N - len(from_decay_onset(cylinder_runs.run_of(pressure)).time)
    assert 478 <= start <= 522


def test_of_two_chambers_the_one_held_longer_counts() -> None:
    one, other = held_then_falling(400, 100.0)[0], held_then_falling(700, 100.0)[0]
    for sides in ((one, other), (other, one)):
        assert N - len(from_decay_onset(cylinder_runs.run_of(*sides)).time) == pytest.approx(700, abs=4)


def test_gas_that_was_held_for_a_second_has_settled_where_the_fall_begins() -> None:
    for held, settled in ((1200, True), (300, False)):
        pressure, _ = held_then_falling(held, 400.0)
        run = cylinder_runs.run_of(pressure)
        step = float(run.time[1] - run.time[0])
        late = from_decay_onset(replace(run, time=run.time * 1e-3 / step))  # samples of 1 ms
        assert late.settled is settled and not run.settled
        assert late.part(0, 500).settled is settled and not late.part(500, 1000).settled
