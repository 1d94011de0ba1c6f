"""Standard errors against closed forms: white residuals, correlated ones, priors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.least_squares import Fit, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH, bounded_interval, error_of_sum, interval, standard_errors

N = 4000
MEAN = FreeParameter("effect", "piston", "mean", "1", Target.SENSOR, 1.0, -10.0, 10.0)
HELD = FreeParameter("effect", "piston", "mean", "1", Target.SENSOR, 1.0, -10.0, 10.0, (0.0, 1e-3))


class Rows:
    """Rows in blocks of 40."""

    blocks = np.arange(N) // 40
    size = N


def fitted(noise: np.ndarray, parameter: FreeParameter = MEAN) -> Fit:
    return fit(lambda values: noise + values[parameter], (parameter,), {parameter: 0.0}, tolerance=1e-9)


def error(noise: np.ndarray, correlation: float = 1.0, parameter: FreeParameter = MEAN) -> float:
    return standard_errors(Rows(), fitted(noise, parameter), correlation)[parameter]


def test_the_mean_of_white_noise_is_known_to_its_root() -> None:
    noise = np.random.default_rng(1).standard_normal(N)
    assert error(noise) == pytest.approx(1.0 / np.sqrt(N), rel=0.1)


def test_correlated_rows_count_as_fewer() -> None:
    """Blocks that share one error each: as many independent rows as there are blocks, found by the clustered sandwich alone."""
    shared = np.repeat(np.random.default_rng(2).standard_normal(N // 40), 40)
    assert error(shared) == pytest.approx(1.0 / np.sqrt(N / 40), rel=0.15)
    assert error(np.random.default_rng(1).standard_normal(N), 40.0) == pytest.approx(1.0 / np.sqrt(N / 40), rel=0.1)


def test_a_prior_bounds_the_error() -> None:
    noise = np.random.default_rng(1).standard_normal(N)
    assert error(noise, 400.0, HELD) < 1.05e-3


def test_what_priors_alone_tell_apart_is_as_uncertain_as_they_are() -> None:
    """A valve's area and a volume that scale together: rows that are missed by more than noise do not make them vaguer than data sheets."""
    rng = np.random.default_rng(5)
    names = [FreeParameter("effect", "piston", name, "1", Target.SENSOR, 0.1, -10.0, 10.0, (1.0, 0.1)) for name in ("area", "volume")]
    shape, blocks = rng.standard_normal(480), np.arange(480) // 40

    class Few:
        size = 480

        @property
        def blocks(self) -> np.ndarray:
            return blocks

    area, volume = names

    def fitted_to(missed: np.ndarray) -> Fit:
        def residual(values: dict[FreeParameter, float]) -> np.ndarray:
            apart, together = values[area] - values[volume], values[area] + values[volume]
            return np.asarray(missed + 1000.0 * shape * apart + 0.3 * np.roll(shape, 1) * together)

        return fit(residual, names, dict.fromkeys(names, 1.0), tolerance=1e-9)

    for _ in range(20):
        found = fitted_to(20.0 * np.repeat(rng.standard_normal(12), 40) * shape)
        errors = standard_errors(Few(), found, 10.0)
        for name in names:
            assert 0.06 < errors[name] < 0.11


def test_intervals_cover_nineteen_of_twenty() -> None:
    rng, covered = np.random.default_rng(3), 0
    for _ in range(200):
        noise = rng.standard_normal(N)
        found = fitted(noise)
        low, high = interval(found.values[MEAN], standard_errors(Rows(), found, 1.0)[MEAN])
        covered += low < 0.0 < high
    assert 0.9 <= covered / 200 <= 0.99


def test_intervals_cover_as_many_where_blocks_are_as_few_as_parameters() -> None:
    """A dozen blocks that share an error each, and ten parameters: residuals are small where the fit bent to them."""
    rng, blocks = np.random.default_rng(4), np.arange(480) // 40
    names = [FreeParameter("effect", "piston", f"size_{i}", "1", Target.SENSOR, 1.0, -100.0, 100.0) for i in range(10)]

    class Few:
        size = 480

        @property
        def blocks(self) -> np.ndarray:
            return blocks

    def of_shapes(noise: np.ndarray, shapes: np.ndarray) -> Fit:
        return fit(lambda values: noise + shapes @ np.array([values[q] for q in names]), names, dict.fromkeys(names, 0.0), tolerance=1e-9)

    covered, widths = 0, []
    for _ in range(60):
        shapes = rng.standard_normal((blocks.size, len(names)))
        noise = np.repeat(rng.standard_normal(12), 40) * shapes[:, 0] + rng.standard_normal(blocks.size)
        found = of_shapes(noise, shapes)
        error = standard_errors(Few(), found, 1.0)[names[0]]
        covered += abs(found.values[names[0]]) < HALF_WIDTH * error
        widths.append(error)
    assert 0.88 <= covered / 60 <= 1.0
    assert 0.9 / np.sqrt(12) < np.median(widths) < 1.5 / np.sqrt(12)


def test_an_interval_stays_inside_the_bounds() -> None:
    assert bounded_interval(MEAN, 9.5, 1.0)[1] == 10.0
    assert interval(9.5, 1.0)[1] == pytest.approx(9.5 + 1.959964)


@pytest.mark.parametrize("error", [0.02, 0.2, 2.0, 200.0])
def test_the_interval_of_a_throttle_is_that_of_its_drop_of_pressure(error: float) -> None:
    """The drop goes with the inverse of its square; with a large error the area is as wide as it was sought, and not as narrow."""
    throttle = replace(MEAN, low=1e-3, high=10.0, saturates=True)
    low, high = bounded_interval(throttle, 2.0, error)
    slope = 2.0 / 2.0**3  # of the inverse square
    assert low**-2 == pytest.approx(2.0**-2 + HALF_WIDTH * slope * error)
    assert high == 10.0 or high**-2 == pytest.approx(2.0**-2 - HALF_WIDTH * slope * error)
    assert low > 0.05


def test_nothing_fitted_has_no_error() -> None:
    assert standard_errors(Rows(), Fit((), {}, np.zeros(N), np.zeros((N, 0))), 1.0) == {}


def test_a_sum_is_known_where_its_parts_are_not() -> None:
    """Two columns that are the same but for a hundredth: each is known a hundred times worse than their sum, of which nil is known."""
    rng = np.random.default_rng(3)
    noise, shape = rng.standard_normal(N), 0.01 * rng.standard_normal(N)
    pair = [FreeParameter("effect", "piston", name, "1", Target.SENSOR, 1.0, -10.0, 10.0) for name in ("one", "other")]
    found = fit(lambda v: noise + v[pair[0]] + (1.0 + shape) * v[pair[1]], pair, dict.fromkeys(pair, 0.0), tolerance=1e-9)
    errors = standard_errors(Rows(), found, 1.0)
    assert min(errors.values()) > 50.0 / np.sqrt(N)
    assert error_of_sum(Rows(), found, 1.0, dict.fromkeys(pair, 1.0)) == pytest.approx(1.0 / np.sqrt(N), rel=0.1)
    assert error_of_sum(Rows(), found, 1.0, {pair[0]: 1.0}) == pytest.approx(errors[pair[0]])
    assert error_of_sum(Rows(), found, 1.0, {MEAN: 1.0}) == np.inf
