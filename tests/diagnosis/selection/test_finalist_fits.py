"""Names of a weighed subset, fitted: what nothing is left of goes, and which of two fits a rig is given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation
from exo_sim.diagnosis.selection.finalist_fits import FinalistFits, predicting_best, without_nil
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing

(SIZE,), (TOP,) = waves.BASE.parameters, waves.ON_TOP.parameters


def refitted(model: waves.Waves, *candidates: Candidate) -> FittedModel:
    """Return the fit of the most probable subset."""
    basis, target = joined([], model.size), -model.residual({})
    linear = Linearisation(None, {}, target, np.zeros((target.size, 0)), tuple(waves.term(model, each) for each in candidates))
    weighing = SubsetWeighing(LinearFamily((), (linear,)), basis, model.blocks)
    best = weighing.finalists()[0]
    return FinalistFits(ModelFits(model, (), cheap=True), weighing, basis).refitted(best, weighing.candidates(best)).model


def test_names_are_fitted_from_the_numbers_of_their_subset() -> None:
    final = refitted(waves.Waves(slow=3.0), waves.BASE)
    assert final.candidates == (waves.BASE,) and final.fit.values[SIZE] == pytest.approx(3.0, abs=0.2)


@pytest.mark.parametrize(("limit", "named"), [(2.0, 1), (4.0, 0)])
def test_what_a_healthy_machine_has_as_well_is_left_to_the_nuisance_parameters(limit: float, named: int) -> None:
    limited = replace(waves.BASE, parameters=(replace(SIZE, healthy_limit=limit),))
    assert len(refitted(waves.Waves(slow=3.0), limited).candidates) == named


def test_what_nothing_is_left_of_goes_and_what_took_its_place_goes_first() -> None:
    both = (waves.BASE, waves.ON_TOP)
    assert without_nil(both, {SIZE: 1.0, TOP: 1.0}) == both
    assert without_nil(both, {SIZE: 1.0, TOP: 0.0}) == (waves.BASE,)
    assert without_nil(both, {SIZE: 0.0, TOP: 1.0}) == (waves.BASE,)
    assert without_nil((waves.BASE,), {SIZE: 0.0}) == ()


def _friction(effect: str, *numbers: str) -> Candidate:
    """Return dry friction of these numbers, the waves of a model of the same names."""
    parameters = tuple(replace(waves.parameter(effect, "", low=0.0), parameter=name) for name in numbers)
    return Candidate(effect, "piston", "+".join(numbers), parameters, ((1.0,) * len(numbers),))


@pytest.mark.parametrize(
    ("constant", "most", "named"), [(0.0, 10.0, "asymmetric_friction"), (2.0, 10.0, "coulomb_friction"), (2.0, 1.0, "asymmetric_friction")]
)
def test_two_directions_that_a_zero_within_its_data_sheet_makes_are_one(constant: float, most: float, named: str) -> None:
    """Zeros are known better than that by most sensors' spread, which does not say that no sensor is off by as much.

    What no zero makes up for is plain, though the noise is taken to be three times as large as it is.
    """
    outward, white = np.sin(waves.AT / 7.0) > 0.0, np.random.default_rng(7).choice([-1.0, 1.0], waves.AT.size)
    shapes = {"forward": white * outward, "backward": -white * ~outward, "force": white * np.where(outward, 1.0, -1.0), "zero": white}
    model = waves.Waves(shapes=shapes, forward=9.0, backward=6.0)
    model._error -= 0.7 * np.random.default_rng(8).standard_normal(waves.AT.size)  # of its noise, which is of this seed
    zero = replace(waves.parameter("zero", "zero", prior=(0.0, 0.3)), high=most)
    apart, plain = _friction("asymmetric_friction", "forward", "backward"), _friction("coulomb_friction", "force")
    basis, target = joined([], model.size), -model.residual({})
    terms = tuple(waves.term(model, each, "dry") for each in (apart, plain))
    linear = Linearisation(None, {}, target, shapes["zero"][:, None], terms)
    weighing = SubsetWeighing(LinearFamily((zero,), (linear,), constant=constant), basis, model.blocks)
    found = FinalistFits(ModelFits(model, (zero,), cheap=True), weighing, basis)
    final = found.refitted(weighing.finalists()[0], (apart,)).model
    assert [c.effect for c in final.candidates] == [named]


@pytest.mark.parametrize(("off", "plain_is_taken"), [(0.9, True), (1.1, False)])
def test_the_plain_fit_is_taken_where_it_is_within_a_standard_error(off: float, plain_is_taken: bool) -> None:
    final, plain = (FittedModel.at({SIZE: value}, (waves.BASE,)) for value in (2.0, 2.0 + off))
    assert predicting_best(final, plain, {SIZE: 1.0}) is (plain if plain_is_taken else final)
