"""Least squares where a number's range spans decades, and where the Jacobian that is handed in is not the true one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exo_sim.diagnosis.estimation.least_squares import LARGEST_LOG_STEP, Derivatives, differences, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target

AT = np.linspace(0.0, 4.0, 200)
TRUE = 0.8
T = FreeParameter("effect", "piston", "time_constant", "s", Target.CYLINDER, 1.0, 1e-4, 1e4, logarithmic=True)
R = FreeParameter("effect", "piston", "rate", "1/s", Target.CYLINDER, 1.0, 1e-4, 1e4, logarithmic=True)
SIZE = FreeParameter("effect", "piston", "size", "1", Target.CYLINDER, 1.0, -10.0, 10.0)


def decay(values: dict[FreeParameter, float]) -> np.ndarray:
    return 50.0 * (np.exp(-AT / values[T]) - np.exp(-AT / TRUE))


def both(values: dict[FreeParameter, float]) -> np.ndarray:
    return 50.0 * (values[SIZE] * np.exp(-AT * values[R]) - 2.0 * np.exp(-AT / TRUE))


@given(decades=st.floats(-1.2, 1.2))
@settings(max_examples=30)
def test_a_time_constant_is_found_from_a_decade_off(decades: float) -> None:
    found = fit(decay, (T,), {T: TRUE * 10.0**decades}, max_iterations=40, tolerance=1e-9)
    assert found.values[T] == pytest.approx(TRUE, rel=1e-3)


@pytest.mark.parametrize("off", [0.1, 0.3, 3.0, 10.0])
def test_a_rate_is_found_beside_a_plain_number(off: float) -> None:
    found = fit(both, (SIZE, R), {SIZE: 1.0, R: off / TRUE}, max_iterations=40, tolerance=1e-9)
    assert found.values[R] == pytest.approx(1.0 / TRUE, rel=1e-3)
    assert found.values[SIZE] == pytest.approx(2.0, rel=1e-3)


@given(start=st.floats(1e-3, 1e3))
@settings(max_examples=30)
def test_no_step_changes_a_logarithm_by_more_than_it_may(start: float) -> None:
    asked: list[tuple[float, float]] = []

    def watched(values: dict[FreeParameter, float]) -> np.ndarray:
        r = decay(values)
        asked.append((values[T], float(r @ r)))
        return r

    fit(watched, (T,), {T: start}, max_iterations=40)
    here, cost = asked[0]
    for value, there in asked[1:]:
        assert abs(math.log(value / here)) <= LARGEST_LOG_STEP + 1e-9
        if there < cost:
            here, cost = value, there


def test_it_goes_as_far_as_it_may_where_far_is_right() -> None:
    found = fit(lambda v: np.full(9, math.log(v[R] / 1e3)), (R,), {R: 1.0}, max_iterations=2, tolerance=0.0)
    assert found.values[R] == pytest.approx(math.exp(2.0 * LARGEST_LOG_STEP), rel=1e-6)


def test_its_columns_are_in_the_logarithm() -> None:
    start = {T: 0.2}
    column = differences(decay, (T,), start, decay(start))[:, 0]
    exact = 50.0 * np.exp(-AT / 0.2) * AT / 0.2  # d exp(-t/T) / d log T
    np.testing.assert_allclose(column, exact, atol=0.03 * exact.max())


def test_it_keeps_to_the_bounds_of_a_wide_number() -> None:
    tight = FreeParameter("effect", "piston", "time_constant", "s", Target.CYLINDER, 1.0, 0.02, 0.5, logarithmic=True)
    found = fit(lambda v: 50.0 * (np.exp(-AT / v[tight]) - np.exp(-AT / TRUE)), (tight,), {tight: 0.03}, max_iterations=40)
    assert found.values[tight] == pytest.approx(0.5)


@pytest.mark.parametrize("kind", ["turned round", "nothing", "noise", "of elsewhere", "exchanged", "far too small", "far too large"])
def test_a_stale_jacobian_still_ends_at_the_minimum(kind: str) -> None:
    quantities = (SIZE, R)
    start = {SIZE: 1.0, R: 0.5}
    true = differences(both, quantities, start, both(start))
    elsewhere = {SIZE: -5.0, R: 20.0}
    columns = {
        "turned round": -true,
        "nothing": 0.0 * true,
        "noise": 30.0 * np.random.default_rng(4).standard_normal(true.shape),
        "of elsewhere": differences(both, quantities, elsewhere, both(elsewhere)),
        "exchanged": true[:, ::-1],
        "far too small": 1e-3 * true,
        "far too large": 1e3 * true,
    }[kind]
    known = dict(zip(quantities, columns.T, strict=True))
    found = fit(both, quantities, start, max_iterations=40, tolerance=1e-6, derivatives=Derivatives(known, exact=True))
    assert found.values[SIZE] == pytest.approx(2.0, rel=5e-3)
    assert found.values[R] == pytest.approx(1.0 / TRUE, rel=5e-3)
    at_end = differences(both, quantities, found.values, found.residual)
    np.testing.assert_allclose(found.jacobian, at_end, atol=1e-9)


def test_a_step_that_fails_is_followed_by_a_shorter_one() -> None:
    steep = lambda values: np.full(40, (0.3 / values[T]) ** 12 - (0.3 / 0.25) ** 12)  # noqa: E731
    found = fit(steep, (T,), {T: 0.4}, max_iterations=40, tolerance=1e-9)  # flat above, a wall below: Newton's step is 23 e-folds long
    assert found.values[T] == pytest.approx(0.25, rel=1e-3)


def test_a_number_at_nil_has_a_derivative_and_no_warnings() -> None:
    leak = FreeParameter("effect", "piston", "leak", "1", Target.CYLINDER, 1e-3, 0.0, 1e4, logarithmic=True)
    with np.errstate(all="raise"):
        (column,) = differences(lambda values: AT * values[leak], (leak,), {leak: 0.0}, np.zeros_like(AT)).T
    assert column == pytest.approx(AT * 1e-15, rel=0.05)
