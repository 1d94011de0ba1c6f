"""Friction of two directions that is one number is no richer form, whether the rig has that number or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.simpler_forms import (
    RicherForm,
    in_poorer_forms,
    no_richer_than_needed,
    poorer_where_alike,
    richer_beside,
    rivals_of_either,
    sizes_of_poorer,
)


def number(effect: str, name: str) -> FreeParameter:
    return FreeParameter(effect, "piston", name, "N", Target.CYLINDER, 1.0, 0.0, 1e5)


FORCE, FORWARD, BACKWARD = (
    number("coulomb_friction", "force"), number("asymmetric_friction", "forward"), number("asymmetric_friction", "backward")
)  # fmt: skip
PLAIN = Candidate("coulomb_friction", "piston", "force", (FORCE,), ((1.0,),))
APART = Candidate("asymmetric_friction", "piston", "forward+backward", (FORWARD, BACKWARD), ((1.0, 1.0),))


@pytest.mark.parametrize(("forward", "backward", "kept"), [(10.0, 10.5, PLAIN), (10.0, 14.0, APART)])
def test_where_the_rig_has_none_the_poorer_one_is_found_instead(forward: float, backward: float, kept: Candidate) -> None:
    assert poorer_where_alike([APART], {FORWARD: forward, BACKWARD: backward}, {"coulomb_friction": PLAIN}) == (kept,)


@pytest.mark.parametrize(("constant", "kept"), [(1.9, APART), (2.1, PLAIN)])
def test_two_directions_that_a_constant_force_makes_are_one(constant: float, kept: Candidate) -> None:
    assert poorer_where_alike([APART], {FORWARD: 10.0, BACKWARD: 14.0}, {"coulomb_friction": PLAIN}, constant) == (kept,)


@pytest.mark.parametrize(("backward", "named"), [(21.5, False), (26.0, True)])
def test_what_the_rig_has_and_is_alike_is_no_finding(backward: float, named: bool) -> None:
    instead = replace(APART, fixed=((FORCE, 0.0),))
    assert poorer_where_alike([instead], {FORWARD: 20.0, BACKWARD: backward}, {}) == (instead,) * named


def test_a_poorer_form_that_explains_as_much_is_taken() -> None:
    assert no_richer_than_needed([APART], {APART.key: [(PLAIN, 0.5)]}) == (PLAIN,)
    assert no_richer_than_needed([APART], {APART.key: [(PLAIN, 50.0)]}) == (APART,)


def _with(candidate: Candidate, left: float, penalty: float = 0.0, **numbers: float) -> FittedModel:
    """Return a model of a hundred rows that leaves so much of each."""
    values = {q: numbers[q.parameter] for q in candidate.parameters}
    fit = replace(FittedModel.at(values).fit, residual=np.full(100, left**0.5), penalty=penalty)
    return replace(FittedModel.at(values, (candidate,)), fit=fit)


@pytest.mark.parametrize(
    ("backward", "left", "lost", "constant", "penalty", "kept"),
    [
        (27.8, 0.9, 40.0, 0.0, 0.0, PLAIN), (27.8, 1.3, 40.0, 0.0, 0.0, APART), (27.8, 1.3, 0.5, 0.0, 0.0, PLAIN),
        (40.0, 0.9, 0.5, 0.0, 0.0, APART), (40.0, 1.3, 0.5, 7.0, 0.0, PLAIN), (40.0, 0.9, 40.0, 7.0, 0.0, APART),
        (40.0, 1.3, 6.5, 7.0, 12.0, PLAIN), (40.0, 1.3, 6.5, 7.0, 0.0, APART),
    ],
    ids=[
        "gained below the noise", "gained", "gained nothing", "not alike", "made by sensors", "made by sensors and more",
        "lost by what sensors are off", "lost otherwise",
    ],
)  # fmt: skip
def test_a_richer_form_is_told_apart_by_what_it_gains_beyond_the_noise(
    backward: float, left: float, lost: float, constant: float, penalty: float, kept: Candidate
) -> None:
    """Odds of 10^16 were for 0.2 N between two directions of 28 N, of which a quiet bench's noise explains all."""
    apart, plain = _with(APART, 0.8, forward=28.0, backward=backward), _with(PLAIN, left, penalty, force=28.0)
    found = in_poorer_forms(apart, (APART,), {PLAIN.effect: PLAIN}, constant, lambda *_: plain, lambda *_: lost, 100)
    assert found.candidates == (kept,)


def test_a_fit_with_the_poorer_form_begins_at_the_mean_of_both() -> None:
    """From a typical value a dip of friction may be below the level of the contact, and answers to nothing."""
    assert sizes_of_poorer([APART], [PLAIN], {FORWARD: 41.0, BACKWARD: 39.0}) == {FORCE: 40.0}
    assert sizes_of_poorer([APART], [APART], {FORWARD: 41.0, BACKWARD: 39.0}) == {}
    assert sizes_of_poorer([PLAIN], [PLAIN], {FORCE: 41.0}) == {}


@pytest.mark.parametrize(("backward", "is_beside"), [(22.0, True), (56.0, False)])
def test_the_richer_form_stands_beside_the_poorer_where_fitted_it_is_two(backward: float, is_beside: bool) -> None:
    def fit(candidates: tuple[Candidate, ...]) -> FittedModel:
        return FittedModel.at({FORWARD: 57.0, BACKWARD: backward} if candidates == (APART,) else {FORCE: 40.0}, candidates)

    def log_evidence(model: FittedModel) -> float:
        return 7.0 if model.candidates == (APART,) else 5.0

    found = richer_beside(fit((PLAIN,)), [APART], fit, log_evidence)
    assert found == ({PLAIN.key: RicherForm(APART, -2.0, {FORCE: (22.0, 57.0)})} if is_beside else {})
    assert richer_beside(fit((APART,)), [APART], fit, log_evidence) == {}


def test_what_may_stand_in_the_place_of_the_richer_form_may_stand_in_that_of_the_poorer() -> None:
    other = Candidate("quadratic_drag", "piston", "coefficient", (number("quadratic_drag", "coefficient"),), ((1.0,),))
    beside = {PLAIN.key: RicherForm(APART, -2.0, {})}
    found = rivals_of_either(beside, {APART.key: [(PLAIN, 1.0), (other, 2.0)]})
    assert found[PLAIN.key] == [(APART, -2.0), (other, 2.0)] and found[APART.key] == [(PLAIN, 1.0), (other, 2.0)]
