"""What laws leave open of a number: the mean square about its value over those that explain as much, by their probability."""

from __future__ import annotations

import math

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.laws import Law, errors_about, reach_of_laws

(SIZE,) = waves.BASE.parameters
MODEL = FittedModel.at({SIZE: 2.0}, (waves.BASE,))


def test_a_law_that_is_as_probable_and_gives_another_number_opens_the_interval_to_it() -> None:
    own, other = Law(1.0, True, {SIZE: 2.0}, {SIZE: 0.1}), Law(1.0, True, {SIZE: 3.0}, {SIZE: 0.1})
    assert errors_about(MODEL, [own]) == {SIZE: pytest.approx(0.1)}
    assert errors_about(MODEL, [own, other]) == {SIZE: pytest.approx(math.sqrt(0.01 + 0.5))}
    assert errors_about(MODEL, [own, Law(1e-6, True, {SIZE: 30.0}, {SIZE: 0.1})])[SIZE] == pytest.approx(0.1, rel=0.1)


def test_a_number_of_a_sensor_follows_its_own_law_alone() -> None:
    """The waves' sizes stand for sensors' errors."""
    own, foreign = Law(1.0, True, {SIZE: 2.0}, {SIZE: 0.1}), Law(1.0, False, {SIZE: 3.0}, {SIZE: 0.1})
    assert errors_about(MODEL, [own, foreign]) == {SIZE: pytest.approx(0.1)}


def test_of_what_the_model_does_not_hold_nothing_is_said() -> None:
    (other,) = waves.OTHER.parameters
    assert errors_about(MODEL, [Law(1.0, True, {other: 1.0}, {other: 0.1})]) == {}


def test_one_law_reaches_as_far_as_its_own_interval() -> None:
    below, above = reach_of_laws(MODEL, [Law(1.0, True, {SIZE: 2.0}, {SIZE: 0.1})])[SIZE]
    assert (below, above) == pytest.approx((0.1, 0.1), rel=1e-6)


def test_a_law_of_a_tenth_of_the_probability_lies_within_the_reach_and_one_of_a_hundredth_does_not() -> None:
    own = Law(1.0, True, {SIZE: 2.0}, {SIZE: 0.1})
    for weight, far in ((0.1, True), (0.01, False)):
        below, above = reach_of_laws(MODEL, [own, Law(weight, True, {SIZE: 30.0}, {SIZE: 0.1})])[SIZE]
        assert below < 0.12
        assert (2.0 + HALF_WIDTH * above > 29.9) is far


def test_the_reach_of_two_laws_is_that_of_drawn_samples() -> None:
    drawn = np.random.default_rng(3).choice(2, 400_000, p=(0.7, 0.3))
    samples = np.where(drawn == 0, 2.0, 2.6) + np.where(drawn == 0, 0.2, 0.5) * np.random.default_rng(4).normal(size=drawn.size)
    laws = [Law(0.7, True, {SIZE: 2.0}, {SIZE: 0.2}), Law(0.3, True, {SIZE: 2.6}, {SIZE: 0.5})]
    below, above = reach_of_laws(MODEL, laws)[SIZE]
    ends = np.quantile(samples, (0.025, 0.975))
    assert (2.0 - HALF_WIDTH * below, 2.0 + HALF_WIDTH * above) == pytest.approx(tuple(ends), abs=0.01)
