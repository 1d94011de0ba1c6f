"""A map that learns from what a change did."""

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.learnt_map import LearntMap

RANDOM = np.random.default_rng(3)
TRUE, BELIEVED = RANDOM.normal(size=(30, 6)), RANDOM.normal(size=(30, 6))
EFFORT = np.full(6, 0.1)


def test_corrections_with_a_true_map_leave_the_least_loads() -> None:
    load, at = RANDOM.normal(size=30), RANDOM.normal(size=6)
    it = LearntMap(TRUE, EFFORT)
    done = at - it.correction(load, at)
    left = load + TRUE @ (done - at)
    np.testing.assert_allclose(TRUE.T @ left + EFFORT**2 * done, 0.0, atol=1e-9)


def test_a_damped_change_is_the_correction_where_nothing_damps_and_smaller_the_more_does() -> None:
    random = np.random.default_rng(4)
    load, at = random.normal(size=30), random.normal(size=6)
    it = LearntMap(TRUE, EFFORT)

    def damped_by(by: float) -> NDArray[np.float64]:
        return it.damped(load, at, lambda effect: by * effect)

    plain, little, much = map(damped_by, (0.0, 0.1, 10.0))
    np.testing.assert_allclose(plain, it.correction(load, at))
    assert np.linalg.norm(much) < np.linalg.norm(little) < np.linalg.norm(plain)
    before, after = (it.promised(load, at, -change) for change in (np.zeros(6), little))
    assert it.promised(load, at, -plain) < after < before
    left = load - TRUE @ little
    np.testing.assert_allclose(after, left @ left + np.sum((EFFORT * (at - little)) ** 2))


def test_a_map_believes_half_of_what_a_change_did_and_nothing_across_it() -> None:
    change = RANDOM.normal(size=6)
    it = LearntMap(BELIEVED, EFFORT)
    after = it.updated(change, TRUE @ change)
    np.testing.assert_allclose(after.effect @ change, 0.5 * (TRUE + BELIEVED) @ change)
    across = np.linalg.svd((BELIEVED.T @ BELIEVED + np.diag(EFFORT**2) @ np.eye(6)) @ change[:, None])[0][:, 1]
    np.testing.assert_allclose(after.effect @ across, BELIEVED @ across)
    np.testing.assert_allclose(it.updated(change, TRUE @ change, 1.0).effect @ change, TRUE @ change)
    assert it.updated(np.zeros(6), np.ones(30)) is it


def test_what_was_tried_makes_a_wrong_map_better() -> None:
    """Loads that could all be met are met sooner by a map that learns."""
    true, wrong, effort = TRUE[:6] + 3.0 * np.eye(6), TRUE[:6] + 3.0 * np.eye(6) + 0.5 * BELIEVED[:6], np.full(6, 1e-3)
    left = []
    for learns in (True, False):
        it, at, load = LearntMap(wrong, effort), np.zeros(6), RANDOM.normal(size=6)
        for _ in range(30):
            change = -0.5 * it.correction(load, at)
            answer = true @ change
            it = it.updated(change, answer) if learns else it
            at, load = at + change, load + answer
        left.append(float(np.linalg.norm(load)))
    assert left[0] < 0.1 * left[1]
