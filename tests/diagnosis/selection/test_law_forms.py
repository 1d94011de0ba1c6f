"""Forms of laws, fitted as they act: a straight line and one with a power of its own, told apart by what they leave."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import Target
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.law_forms import FittedForm, fitted_forms, plainest, weighed_as_fitted
from exo_sim.diagnosis.selection.laws import Law

(SIZE,) = waves.BASE.parameters
POWER = replace(SIZE, parameter="power", unit="1", target=Target.CYLINDER, prior=(1.0, 0.15))
PLAIN = waves.BASE
SHAPED = replace(PLAIN, form="slow+power", parameters=(SIZE, POWER))
RICHER = replace(PLAIN, form="slow+second", parameters=(SIZE, replace(SIZE, parameter="second")))


def model(candidate: Candidate, size: float, *more: float) -> FittedModel:
    values = dict(zip(candidate.parameters, (size, *more), strict=True))
    found = FittedModel.at(values, (candidate,))
    return replace(found, fit=replace(found.fit, parameters=tuple(values)))


LINE, CURVE = model(PLAIN, 2.0), model(SHAPED, 1.5, 0.8)


def test_effects_are_fitted_in_forms_that_differ_in_shape_alone() -> None:
    fitted: list[tuple[tuple[Candidate, ...], FittedModel]] = []

    def fit(chosen: tuple[Candidate, ...], near: FittedModel) -> FittedModel:
        fitted.append((chosen, near))
        return CURVE

    found = fitted_forms(LINE, (PLAIN, SHAPED, RICHER, waves.OTHER), fit, lambda one: 5.0 if one is LINE else 4.0)
    ((chosen, near),) = fitted
    assert chosen == (SHAPED,) and near.fit.values == {SIZE: 2.0, POWER: 1.0}  # begun as the straight line
    assert [(one.model, one.log_evidence) for one in found] == [(LINE, 5.0), (CURVE, 4.0)]


@pytest.mark.parametrize(("ahead", "chosen"), [(-2.0, LINE), (2.0, LINE), (40.0, CURVE)])
def test_the_form_with_fewest_parameters_stands_unless_another_is_plainly_more_probable(ahead: float, chosen: FittedModel) -> None:
    assert plainest([FittedForm(CURVE, ahead), FittedForm(LINE, 0.0)]) is chosen


def test_laws_weigh_as_their_fits_do_and_not_as_the_grid_has_them() -> None:
    """On the grid the curve was a hundred times more probable, and so it is beside another effect."""
    straight, curved = frozenset({PLAIN.key}), frozenset({SHAPED.key})
    beside = curved | {waves.OTHER.key}
    grid = [
        Law(1.0, True, {SIZE: 9.0}, {SIZE: 0.1}, curved), Law(0.01, False, {SIZE: 2.1}, {SIZE: 0.1}, straight),
        Law(0.5, False, {SIZE: 8.0}, {SIZE: 0.1}, beside),
    ]  # fmt: skip
    errors = {SIZE: 0.2}
    found = weighed_as_fitted(grid, [FittedForm(LINE, 0.0), FittedForm(CURVE, -2.0)], LINE, lambda one: errors)
    weights = {(law.forms, law.values[SIZE]): law.weight for law in found}
    assert set(weights) == {(straight, 2.0), (curved, 1.5), (beside, 8.0)}
    assert weights[straight, 2.0] + weights[curved, 1.5] == pytest.approx(1.01)
    assert weights[curved, 1.5] / weights[straight, 2.0] == pytest.approx(math.exp(-2.0))
    assert weights[beside, 8.0] == pytest.approx(0.5 * (math.exp(-2.0) / (1.0 + math.exp(-2.0))) / (1.0 / 1.01))
    assert [law.own for law in found if law.forms == straight] == [True]


def test_a_model_of_one_form_keeps_its_laws() -> None:
    grid = [Law(1.0, True, {SIZE: 9.0}, {SIZE: 0.1}, frozenset({PLAIN.key}))]
    assert weighed_as_fitted(grid, [FittedForm(LINE, 0.0)], LINE, lambda one: {}) == grid
