"""What is left beyond a fit is what refitting everything free would leave."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.least_squares import Fit, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.selection.cleared import Cleared

RNG = np.random.default_rng(3)
COLUMNS, TARGET = RNG.standard_normal((60, 3)), RNG.standard_normal(60)
FREE = tuple(
    FreeParameter("effect", "part", name, "1", Target.CYLINDER, 1.0, -5.0, 5.0, (0.0, 2.0) if name == "b" else None) for name in "abc"
)


def residual(values: dict[FreeParameter, float], change: np.ndarray | float = 0.0) -> np.ndarray:
    return np.asarray(COLUMNS @ [values[q] for q in FREE] - TARGET + change)


def fitted(change: np.ndarray | float = 0.0) -> Fit:
    return fit(lambda values: residual(values, change), FREE, dict.fromkeys(FREE, 0.0), max_iterations=20, tolerance=1e-12)


def whole(one: Fit) -> float:
    return one.sse + one.prior_weight * one.penalty


def test_what_a_fit_leaves_is_beyond_all_that_is_free() -> None:
    done = fitted()
    left = Cleared.of(done).left
    assert left @ left == pytest.approx(whole(done), rel=1e-6)
    assert np.abs(Cleared.of(done).basis.T @ left).max() < 1e-6


def test_a_change_that_free_parameters_take_up_is_nothing_and_of_another_the_rest_is_left() -> None:
    done = fitted()
    beyond = Cleared.of(done)
    taken_up = beyond.clear(COLUMNS @ [0.2, 0.0, -0.1])
    assert taken_up == pytest.approx(np.zeros_like(taken_up), abs=1e-9)
    change = 0.3 * RNG.standard_normal(60)
    left = beyond.left + beyond.clear(change)
    assert left @ left == pytest.approx(whole(fitted(change)), rel=1e-3)  # the weight of priors moves a little with the fit


def test_what_something_stands_for_is_not_free() -> None:
    done = fitted()
    beyond = Cleared.of(done, {FREE[0].slot})
    assert beyond.basis.shape[1] == 2
    assert np.linalg.norm(beyond.clear(COLUMNS[:, 0])) > 1.0
