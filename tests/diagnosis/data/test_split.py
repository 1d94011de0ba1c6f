"""Training, validation and test time: every sample is one of them."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.data.split import split
from exo_sim.diagnosis.policy.validation import HELD_OUT_SHARE


@pytest.mark.parametrize("head", [False, True])
def test_a_lone_recording_is_training_validation_and_test(head: bool) -> None:
    time = np.linspace(3.0, 13.0, 1001)
    parts = split([("one", time)], head)
    proof, check, fit = parts.in_test("one", time), parts.validation_as_test().in_test("one", time), parts.in_training("one", time)
    assert proof.mean() == pytest.approx(0.5 * HELD_OUT_SHARE, abs=0.002)
    assert check.mean() == pytest.approx(0.5 * HELD_OUT_SHARE, abs=0.002)
    assert (proof | check | fit).all() and not (fit & (proof | check)).any()
    assert (proof & check).sum() <= 1  # the sample between them
    order = np.flatnonzero(proof).mean(), np.flatnonzero(check).mean(), np.flatnonzero(fit).mean()
    assert list(order) == sorted(order, reverse=not head)
    np.testing.assert_array_equal(parts.validation_as_test().in_training("one", time), fit)


@pytest.mark.parametrize(("count", "kept"), [(2, 1), (3, 1), (4, 1), (8, 2)])
def test_of_several_whole_ones_are_held_out_and_none_is_for_validation(count: int, kept: int) -> None:
    names = [f"r{i}" for i in range(count)]
    parts = split([(name, np.linspace(0.0, 1.0, 50)) for name in names])
    assert list(parts.test) == names[-kept:] and not parts.validation
