"""What is learnt of one stride, its loads and its push ahead, changes the demand of the next, and nothing else does."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.least_load import LeastLoad
from exo_sim.control.machine_dynamics import PHASES
from exo_sim.control.stride_learning import OF_PUSH, StrideLearning


class Plan:
    """Two coefficients; the mean force of each strap takes its share off one of them, and the second pushes by so much a newton."""

    best = np.array([10.0, -4.0])

    def __init__(self, pushed: float = 0.0) -> None:
        self.pushed = pushed

    def push(self, forces: NDArray[np.float64]) -> float:
        return float(forces[:, 0].mean())

    def pushing(self) -> NDArray[np.float64]:
        return np.array([0.0, self.pushed])

    def restored(self, change: NDArray[np.float64], forces: NDArray[np.float64], share: float) -> NDArray[np.float64]:
        return np.asarray(change - share * forces.mean(axis=0))

    def table(self, coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
        return coefficients.copy()


def learning(pushed: float = 0.0) -> StrideLearning:
    return StrideLearning(cast(LeastLoad, cast(Any, Plan(pushed))), np.full((PHASES, 2), 5.0))


def walk(learnt: StrideLearning, strides: range, force: float) -> None:
    for stride in strides:
        for step in range(PHASES):
            learnt.take(stride + step / PHASES, np.array([force, 5.0]))


def test_forces_of_the_calibration_change_nothing() -> None:
    learnt = learning()
    walk(learnt, range(3), 5.0)
    np.testing.assert_array_equal(learnt.table, Plan.best)


def test_a_stride_that_is_over_takes_its_share_off() -> None:
    """25 N instead of 5 N: each whole stride takes a fifth of 20 off, the first stride only where the second begins."""
    learnt = learning()
    walk(learnt, range(1), 25.0)
    np.testing.assert_array_equal(learnt.table, Plan.best)
    learnt.take(1.0, np.array([25.0, 5.0]))
    np.testing.assert_allclose(learnt.table, [6.0, -4.0])
    walk(learnt, range(1, 3), 25.0)
    np.testing.assert_allclose(learnt.table[0], 10.0 - 2.0 * 4.0)


def test_the_push_ahead_is_taken_back_by_a_larger_share() -> None:
    """20 N more than in the calibration, by a coefficient of which 0.1 pushes with a newton more."""
    learnt = learning(pushed=0.1)
    walk(learnt, range(1), 25.0)
    learnt.take(1.0, np.array([5.0, 5.0]))
    np.testing.assert_allclose(learnt.table, [6.0, -4.0 - OF_PUSH * 20.0 * 0.1])


def test_a_stride_with_gaps_teaches_nothing() -> None:
    learnt = learning()
    learnt.take(0.0, np.array([25.0, 5.0]))
    learnt.take(1.0, np.array([25.0, 5.0]))
    np.testing.assert_array_equal(learnt.table, Plan.best)


def test_what_was_learnt_can_be_forgotten() -> None:
    learnt = learning()
    walk(learnt, range(2), 25.0)
    assert learnt.table[0] < 10.0
    learnt.forget()
    np.testing.assert_array_equal(learnt.table, Plan.best)
