"""What laws leave open of a number: the mean square about its value over those that explain as much, by their probability."""

from __future__ import annotations

import math

import pytest
from diagnosis import waves

from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.laws import Law, errors_about

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


def test_laws_to_one_side_open_the_interval_to_that_side_alone() -> None:
    own, higher = Law(1.0, True, {SIZE: 2.0}, {SIZE: 0.1}), Law(1.0, True, {SIZE: 30.0}, {SIZE: 0.1})
    assert errors_about(MODEL, [own, higher], -1) == {SIZE: pytest.approx(0.1)}
    assert errors_about(MODEL, [own, higher], 1) == errors_about(MODEL, [own, higher])
