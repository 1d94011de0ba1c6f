"""Smooth functions of a variable, and kinds of them side by side."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.discrepancy.basis import joined, smooth_functions


@given(st.integers(3, 9), st.integers(0, 99))
def test_smooth_functions_hold_any_broken_line_through_their_knots_but_its_mean(knots: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    variable = rng.uniform(-2.0, 5.0, 400)
    columns = smooth_functions(variable, knots)
    assert columns.shape == (400, knots)
    np.testing.assert_allclose(columns.mean(axis=0), 0.0, atol=1e-12)
    low, high = np.percentile(variable, [0.5, 99.5])
    line = np.interp(variable, np.linspace(low, high, knots), rng.standard_normal(knots))
    left = line - line.mean()
    left -= columns @ np.linalg.lstsq(columns, left, rcond=None)[0]
    np.testing.assert_allclose(left, 0.0, atol=1e-9)


def test_what_does_not_vary_has_no_functions() -> None:
    assert smooth_functions(np.full(50, 3.0), 5).shape == (50, 0)
    assert smooth_functions(np.zeros(0), 5).shape == (0, 0)


def test_kinds_stand_side_by_side_and_empty_ones_are_left_out() -> None:
    basis = joined([("place", np.ones((4, 2)), 0.5), ("speed", np.zeros((4, 0)), 1.0), ("time", np.ones((4, 3)), 2.0)], 4)
    assert basis.names == ("place", "time") and basis.columns.shape == (4, 5)
    assert basis.kinds.tolist() == [0, 0, 1, 1, 1] and basis.healthy.tolist() == pytest.approx([0.5, 2.0])
    assert joined([], 4).columns.shape == (4, 0)


def test_a_deviation_is_that_of_the_sum_of_all_its_weights() -> None:
    rng = np.random.default_rng(3)
    basis = joined([("a", rng.standard_normal((5, 2)), 0.4), ("b", rng.standard_normal((5, 3)), 1.5)], 5)
    drawn = basis.columns @ (basis.healthy[basis.kinds][:, None] * rng.standard_normal((5, 40000)))
    np.testing.assert_allclose(basis.deviation(), drawn.std(axis=1), rtol=0.02)
