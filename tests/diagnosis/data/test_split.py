"""Training, validation and test time: every sample is one of them."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.data.split import split
from exo_sim.diagnosis.policy.validation import HELD_OUT_SHARE, TEST_SHARE


@pytest.mark.parametrize("head", [False, True])
def test_a_lone_recording_is_training_validation_and_test(head: bool) -> None:
    time = np.linspace(3.0, 13.0, 1001)
    parts = split([("one", time)], head)
    proof, check, fit = parts.in_test("one", time), parts.validation_as_test().in_test("one", time), parts.in_training("one", time)
    assert proof.mean() == pytest.approx(TEST_SHARE * HELD_OUT_SHARE, abs=0.002)
    assert check.mean() == pytest.approx((1.0 - TEST_SHARE) * HELD_OUT_SHARE, abs=0.002)
    assert (proof | check | fit).all() and not (fit & (proof | check)).any()
    assert (proof & check).sum() <= 1  # the sample between them
    order = np.flatnonzero(proof).mean(), np.flatnonzero(check).mean(), np.flatnonzero(fit).mean()
    assert list(order) == sorted(order, reverse=not head)
    np.testing.assert_array_equal(parts.validation_as_test().in_training("one", time), fit)


@pytest.mark.parametrize("head", [False, True])
def test_of_several_each_gives_its_own_part(head: bool) -> None:
    """None is held out whole: it may be the only one at its pressure or load."""
    times = [(f"r{i}", np.linspace(10.0 * i, 10.0 * i + 1.0 + i, 500)) for i in range(3)]
    parts = split(times, head)
    for name, time in times:
        alone = split([(name, time)], head)
        assert parts.test[name] == alone.test[name] and parts.validation[name] == alone.validation[name]
        assert parts.in_training(name, time).mean() == pytest.approx(1.0 - HELD_OUT_SHARE, abs=0.01)


@pytest.mark.parametrize("head", [False, True])
def test_all_that_is_kept_back_is_what_nothing_is_fitted_to(head: bool) -> None:
    time = np.linspace(3.0, 13.0, 1001)
    parts = split([("one", time)], head)
    np.testing.assert_array_equal(parts.kept_back().in_test("one", time), ~parts.in_training("one", time))
