"""Rows of a gas residual, and the closed form that integrates a window's initial pressure out."""

from __future__ import annotations

import numpy as np
from diagnosis.cylinder_runs import STEP, run_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs, inputs
from exo_sim.diagnosis.subsystems.gas.rows import Rows, rows_of, stiffness_of
from exo_sim.physics.plant_records import CYLINDER, WORLD
from exo_sim.recording.filters import smoothed

N = 1000


def given_run(breaks: tuple[int, ...] = (0,), noise: float = 100.0) -> GasInputs:
    """Return the inputs of a run whose pressure rises by 1 bar within a second."""
    pressure = np.linspace(3e5, 4e5, N)
    return inputs(run_of(pressure, noise=(noise, 0.0), breaks=breaks), np.zeros(1, WORLD), 10.0)


@given(seed=st.integers(0, 10**6), rows=st.integers(1, 30), windows=st.integers(1, 4))
@settings(max_examples=50)
def test_squares_of_marginalised_errors_are_the_likelihood_of_correlated_ones(seed: int, rows: int, windows: int) -> None:
    rng = np.random.default_rng(seed)
    window = np.sort(rng.integers(0, windows, rows))
    errors, response = rng.standard_normal(rows), rng.standard_normal(rows) * rng.integers(0, 2, rows)
    cut = Rows(np.arange(rows), window, np.ones(rows), np.ones(rows))
    covariance = np.eye(rows) + np.outer(response, response) * (window[:, None] == window[None, :])
    white = cut.marginalised(errors, response)
    np.testing.assert_allclose(white @ white, errors @ np.linalg.solve(covariance, errors), rtol=1e-9)


def test_a_row_is_the_mean_of_its_samples_and_no_row_crosses_a_break() -> None:
    given_ = given_run(breaks=(0, 333))
    rows = rows_of(given_, 0, Split({}), 5 * STEP, on_test=False)
    assert set(rows.count) == {5.0, 3.0, 2.0}  # what is left before the break and at the end
    values = np.arange(float(N))
    means = rows.means(values)
    for row in (0, 10, len(means) - 1):
        np.testing.assert_allclose(means[row], values[rows.group == row].mean())
    assert len(np.unique(rows.group[330:333])) == 1 and rows.group[332] != rows.group[333]
    assert (np.diff(rows.window) >= 0).all() and set(rows.window) == {0, 1}


def test_noise_is_averaged_and_the_floor_stays() -> None:
    quiet, noisy = (rows_of(given_run(noise=noise), 0, Split({}), 4 * STEP, on_test=False) for noise in (0.0, 1000.0))
    floor = max(healthy.GAS_FLOOR, healthy.GAS_FLOOR_SHARE * 1e5)
    np.testing.assert_allclose(quiet.scale, floor)
    np.testing.assert_allclose(noisy.scale, np.sqrt(1000.0**2 / 4.0 + floor**2))


def test_time_that_is_held_out_has_rows_of_its_own() -> None:
    split = Split({"recording": ((0.8, 1.0),)})
    training, test = (rows_of(given_run(), 0, split, STEP, on_test=on_test) for on_test in (False, True))
    assert not ((training.group >= 0) & (test.group >= 0)).any()
    assert ((training.group >= 0) | (test.group >= 0)).all()


def test_a_chamber_that_was_not_measured_has_no_rows() -> None:
    rows = rows_of(given_run(), 1, Split({}), STEP, on_test=False)
    assert (rows.group == -1).all() and rows.count.size == 0


def test_beyond_the_rows_is_what_rings_and_not_what_drifts() -> None:
    rows = rows_of(given_run(), 0, Split({}), 5 * STEP, on_test=False)
    slope = np.linspace(0.0, 1e4, N)
    ringing = 50.0 * np.cos(np.pi * np.arange(N))
    assert np.abs(rows.beyond(slope)[5:-5]).max() < 1e-6
    assert np.std(rows.beyond(slope + ringing)) > 40.0


def test_what_a_noisy_position_does_to_the_pressure_of_a_shut_chamber_is_noise_of_its_rows() -> None:
    """A slow logger: p V^k holds in a shut chamber, so a position that scatters shows as a pressure that does."""
    rng = np.random.default_rng(3)
    time: NDArray[np.float64] = np.arange(N, dtype=np.float64) * 5e-3
    truth = 0.05 + 0.02 * np.sin(3.0 * time)
    world, cylinder = np.zeros(1, WORLD), np.zeros(1, CYLINDER)
    world["k"], cylinder["area_1"], cylinder["area_2"], cylinder["stroke"] = 1.4, 8e-4, 7e-4, 0.1
    cylinder["dead_volume_1"] = 8e-6

    def pressure(length: np.ndarray) -> np.ndarray:
        return np.asarray(4e5 * (0.06 / (length + 0.01)) ** 1.4)

    seen = smoothed(time, truth + 8e-5 * rng.standard_normal(N))[0]
    run = run_of(pressure(truth), time=time, length=seen, noise=(0.0, 0.0), position_noise=8e-5)
    feed = inputs(run, world, 10.0)
    rows = rows_of(feed, 0, Split({}), 5e-3, False, stiffness_of(feed, PlantParameters(world, cylinder), 0))
    ratio = rows.means(pressure(truth) - pressure(seen)) / rows.scale
    assert 0.9 < float(np.std(ratio)) < 1.1
