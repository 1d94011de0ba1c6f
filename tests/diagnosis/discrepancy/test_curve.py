"""A missing force as a curve: recovered where there is one, not invented where there is none."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.discrepancy.curve import KNOTS, fit_curve, fit_curves, hats

N = 3000
RNG = np.random.default_rng(4)
PLACE = RNG.uniform(-1.0, 1.0, N)
BLOCKS = np.arange(N) // 50


def test_a_bump_is_recovered_with_its_share_of_the_variance() -> None:
    bump, noise = 3.0 * np.exp(-((PLACE / 0.4) ** 2)), RNG.standard_normal(N)
    found = fit_curve("position", PLACE, bump + noise, BLOCKS)
    assert found is not None and len(found.at) == KNOTS
    np.testing.assert_allclose(found(PLACE), bump, atol=0.4)
    assert found.explains == pytest.approx(np.var(bump) / np.var(bump + noise), abs=0.03)
    inside = np.abs(found.values - 3.0 * np.exp(-((found.at / 0.4) ** 2))) < 1.5 * found.band + 0.1
    assert inside.mean() > 0.8


def test_noise_follows_nothing() -> None:
    found = fit_curve("position", PLACE, RNG.standard_normal(N), BLOCKS)
    assert found is not None and found.explains < 0.02


def test_the_variable_that_predicts_most_comes_first() -> None:
    other = RNG.uniform(-1.0, 1.0, N)
    found = fit_curves({"velocity": other, "position": PLACE, "short": PLACE[:5]}, np.abs(PLACE), BLOCKS)
    assert [curve.variable for curve in found] == ["position", "velocity"]


def test_a_variable_that_does_not_vary_has_no_curve() -> None:
    assert fit_curve("position", np.full(N, 0.3), PLACE, BLOCKS) is None
    assert fit_curve("position", PLACE[:20], PLACE[:20], BLOCKS[:20]) is None


@given(st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=20))
def test_weights_are_a_partition_of_one(values: list[float]) -> None:
    at = np.linspace(-1.0, 1.0, 7)
    weights = hats(np.array(values), at)
    np.testing.assert_allclose(weights.sum(1), 1.0)
    np.testing.assert_allclose(weights @ at, np.clip(values, -1.0, 1.0), atol=1e-12)
