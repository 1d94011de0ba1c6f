"""A fit that ended where a smaller model leaves less is done again from there."""

from __future__ import annotations

import math

import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.nested_fits import no_worse_than_nested

(SIZE,), (OTHER,) = waves.BASE.parameters, waves.OTHER.parameters
BOTH = (waves.BASE, waves.OTHER)


class Valleys(waves.Waves):
    """A size above 5 stands in a valley of its own about 7, where another wave is left: no step leads out of it."""

    def residual_of(self, plant: waves.PlantParameters) -> waves.Array:
        found, size = super().residual_of(plant), plant.sensors.get(SIZE.parameter, 0.0)
        return found - (9.0 * waves.SHAPES["slow"] - 3.0 * waves.SHAPES["quick"] if size > 5.0 else 0.0)


def fitted_from(size: float) -> tuple[ModelFits, FittedModel]:
    fits = ModelFits(Valleys(slow=-2.0, quicker=3.0), (), cheap=True)
    return fits, fits.fit(BOTH, FittedModel.at({SIZE: size, OTHER: 0.0}))


@pytest.mark.parametrize("size", [0.5, 7.5])
def test_a_fit_in_a_valley_where_a_nested_model_leaves_less_is_begun_from_that(size: float) -> None:
    fits, model = fitted_from(size)
    found = no_worse_than_nested(model, fits.fit, fits.deficit)
    assert found.fit.values[SIZE] == pytest.approx(-2.0, abs=0.3) and found.fit.values[OTHER] == pytest.approx(3.0, abs=0.3)
    assert (found is model) is (size < 5.0)


def test_it_ends_where_no_beginning_is_better() -> None:
    """However good a nested model is said to be, a fit that is not bettered from it stands."""
    model = FittedModel.at({SIZE: 1.0, OTHER: 1.0}, BOTH)

    def fit(candidates: tuple[Candidate, ...], near: FittedModel, again: bool) -> FittedModel:
        return model if candidates == BOTH else FittedModel.at(dict(near.fit.values), candidates)

    def deficit(one: FittedModel, other: FittedModel) -> float:
        return 0.0 if one.candidates == other.candidates else math.copysign(50.0, len(one.candidates) - len(other.candidates))

    assert no_worse_than_nested(model, fit, deficit) is model
