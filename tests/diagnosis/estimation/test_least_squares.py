"""Least squares: finds the minimum, keeps to bounds, and a wrong model does not bend nominal numbers."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.least_squares import Derivatives, differences, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target

AT = np.linspace(0.0, 4.0, 400)


def quantity(name: str, low: float = -10.0, high: float = 10.0, prior: tuple[float, float] | None = None) -> FreeParameter:
    return FreeParameter("effect", "piston", name, "1", Target.SENSOR, 1.0, low, high, prior)


A, B = quantity("a"), quantity("b")


def decay(values: dict[FreeParameter, float]) -> np.ndarray:
    return 50.0 * (values[A] * np.exp(-values[B] * AT) - 2.0 * np.exp(-0.7 * AT))


@pytest.mark.parametrize("carried", [False, True])
def test_it_finds_the_minimum(carried: bool) -> None:
    start = {A: 1.0, B: 0.3}
    known = dict(zip((A, B), differences(decay, (A, B), start, decay(start)).T, strict=True)) if carried else None
    found = fit(decay, (A, B), start, max_iterations=40, tolerance=1e-9, derivatives=Derivatives(known))
    assert found.values[A] == pytest.approx(2.0, rel=1e-3)
    assert found.values[B] == pytest.approx(0.7, rel=1e-3)


def test_a_carried_jacobian_costs_fewer_predictions() -> None:
    counts = []
    start = {A: 1.8, B: 0.6}
    for known in (None, dict(zip((A, B), differences(decay, (A, B), start, decay(start)).T, strict=True))):
        calls: list[int] = []
        counted = lambda v, calls=calls: calls.append(1) or decay(v)  # type: ignore[misc, func-returns-value]  # noqa: E731
        fit(counted, (A, B), start, max_iterations=20, derivatives=Derivatives(known))
        counts.append(len(calls))
    assert counts[1] < counts[0]


def test_a_jacobian_that_was_differenced_where_a_fit_ended_is_not_differenced_again() -> None:
    calls: list[int] = []

    def missed(values: dict[FreeParameter, float]) -> np.ndarray:
        calls.append(1)
        return decay(values) + 3.0 * np.sin(20.0 * AT)

    first = fit(missed, (A, B), {A: 1.0, B: 0.3}, max_iterations=40, tolerance=1e-9, derivatives=Derivatives(exact=True))
    calls.clear()
    again = fit(missed, (A, B), first.values, derivatives=Derivatives(first.columns, exact=True, differenced_at=first.differenced_at))
    assert len(calls) <= 1 + 5  # the start, and steps that lead no further
    np.testing.assert_array_equal(again.jacobian, first.jacobian)
    moved = fit(missed, (A, B), {A: 1.2, B: 0.5}, derivatives=Derivatives(first.columns, exact=True, differenced_at=first.differenced_at))
    np.testing.assert_allclose(moved.jacobian, differences(missed, (A, B), moved.values, moved.residual), rtol=1e-2, atol=1e-2)


def test_a_law_that_bends_long_before_its_slope_is_followed_up_is_fitted_all_the_same() -> None:
    """Its slope asks for steps twenty times as long as what lowers the error; no more than five damped ones leave it where it began."""
    found = fit(lambda values: np.array([1.0 - values[A], 1000.0 * max(values[A] - 0.05, 0.0)]), (A,), {A: 0.0}, max_iterations=40)
    assert 0.95**2 <= found.sse < 0.95


def test_it_keeps_to_bounds() -> None:
    bounded = quantity("b", 0.0, 0.5)
    found = fit(lambda v: 50.0 * (2.0 * np.exp(-v[bounded] * AT) - 2.0 * np.exp(-0.7 * AT)), (bounded,), {bounded: 0.1})
    assert found.values[bounded] == pytest.approx(0.5)


def test_an_error_that_is_not_theirs_does_not_bend_believed_numbers() -> None:
    believed = quantity("factor", prior=(1.0, 0.1))
    length = 40.0
    wrong = 200.0 * np.sin(AT)  # something is missing that a factor can hide a little of
    residual = lambda v: 30.0 * (v[believed] - 1.0) * AT + wrong  # noqa: E731
    free = fit(residual, (believed,), {believed: 1.0}, correlation_length=1.0)
    held = fit(residual, (believed,), {believed: 1.0}, correlation_length=length)
    assert abs(held.values[believed] - 1.0) < 0.1
    assert abs(held.values[believed] - 1.0) < abs(free.values[believed] - 1.0)


def test_no_number_is_the_worst() -> None:
    found = fit(lambda v: np.full(5, np.nan), (A,), {A: 1.0})
    assert np.isfinite(found.residual).all() and found.sse > 1e8


def test_a_fit_whose_time_is_up_ends_where_it_is() -> None:
    calls: list[int] = []

    def counted(values: dict[FreeParameter, float]) -> np.ndarray:
        calls.append(1)
        return decay(values)

    steps: list[int] = []

    def after_two() -> bool:
        steps.append(1)
        return len(steps) > 3

    start = {A: 1.0, B: 0.3}
    whole = fit(decay, (A, B), start, max_iterations=40, tolerance=1e-9, derivatives=Derivatives(exact=True))
    ended = fit(counted, (A, B), start, max_iterations=40, tolerance=1e-9, derivatives=Derivatives(exact=True), is_spent=after_two)
    assert whole.sse < ended.sse < float(decay(start) @ decay(start))
    calls.clear()
    at_once = fit(counted, (A, B), start, max_iterations=40, derivatives=Derivatives(exact=True), is_spent=lambda: True)
    assert at_once.values == start and len(calls) == 1 + 2
