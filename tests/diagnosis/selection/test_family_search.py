"""The search over a linear family of waves: everything at once, from both ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation, Term
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.family_search import FamilySearch
from exo_sim.diagnosis.selection.fitted_model import SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits

#: Two waves that hide each other: each alone explains next to nothing of their difference.
TWINS = {"one": np.sin(waves.AT / 20.0), "two": np.sin(waves.AT / 20.0) + 0.15 * np.sin(waves.AT / 7.0), **waves.SHAPES}


def searched(model: waves.Waves, *terms: Term, others: tuple[Linearisation, ...] = ()) -> SearchResult:
    target = -model.residual({})
    plain = Linearisation(None, {}, target, np.zeros((target.size, 0)), terms)
    return FamilySearch(ModelFits(model, (), cheap=True), LinearFamily((), (plain, *others)), joined([], target.size)).run()


def test_waves_that_hide_each_other_are_both_found() -> None:
    """Their sum is 0.75 of the noise, and neither alone lowers the error by half of that."""
    model = waves.Waves(shapes=TWINS, one=-5.0, two=5.0)
    one, two = waves.candidate("first", "one"), waves.candidate("second", "two")
    found = searched(model, waves.term(model, one), waves.term(model, two), waves.term(model, waves.OTHER))
    assert found.final.named == {one.at, two.at}
    for candidate, size in ((one, -5.0), (two, 5.0)):
        assert found.final.fit.values[candidate.parameters[0]] == pytest.approx(size, abs=1.2)
        assert found.probabilities[candidate.at] > 0.95
    assert found.probabilities[waves.OTHER.at] < 0.2


def test_probabilities_of_names_for_the_same_wave_add_up() -> None:
    model = waves.Waves(slow=3.0)
    twin = waves.candidate("twin", "slow")
    found = searched(model, waves.term(model, waves.BASE), waves.term(model, twin))
    assert sum(found.probabilities.values()) == pytest.approx(1.0, abs=0.05)
    (candidate,) = found.final.candidates
    ((rival, worse),) = found.rivals[candidate.key]
    assert {candidate.effect, rival.effect} == {"base", "twin"} and worse == pytest.approx(0.0, abs=1e-6)


def test_what_comes_on_top_needs_its_base_or_a_richer_form_of_it() -> None:
    model = waves.Waves(quick=5.0)
    alone = searched(model, waves.term(model, waves.BASE), waves.term(model, waves.ON_TOP))
    assert alone.final.named in (set(), {waves.BASE.at, waves.ON_TOP.at})
    both = waves.Waves(slow=2.0, quick=5.0)
    richer = waves.candidate("richer", "slow", "level")
    terms = [waves.term(both, waves.BASE, "base"), waves.term(both, richer, "base"), waves.term(both, waves.ON_TOP)]
    assert searched(both, *terms).final.named == {waves.BASE.at, waves.ON_TOP.at}


@pytest.mark.parametrize(("size", "spread", "named"), [(0.6, 1.0, False), (0.6, 5.0, True), (1.4, 1.0, True)])
def test_what_is_below_the_noise_and_pulls_nuisance_parameters_off_is_no_finding(size: float, spread: float, named: bool) -> None:
    """The name does what is left of a quick wave together with a nuisance parameter that undoes the rest of it.

    The noise of a row is set as high as 1.25 times what it is: a floor stands under what sensors say.
    """

    class Floored(waves.Waves):
        def residual_of(self, plant: PlantParameters) -> waves.Array:
            return 0.8 * super().residual_of(plant)

    model = Floored(shapes={**TWINS, "rest": size * np.sin(waves.AT / 7.0)}, rest=1.0)
    nuisance = waves.parameter("known", "one", prior=(0.0, spread), low=-100.0)
    name = waves.candidate("name", "two")
    target = -model.residual({})
    linear = Linearisation(None, {}, target, spread * model.shapes["one"][:, None], (waves.term(model, name),))
    fits = ModelFits(model, (replace(nuisance, high=100.0),), cheap=True)
    found = FamilySearch(fits, LinearFamily(fits.nuisances, (linear,)), joined([], target.size)).run()
    assert bool(found.final.candidates) is named


@pytest.mark.parametrize(("quicker", "unnamed"), [(0.0, ()), (4.0, ("position",))])
def test_what_names_do_where_they_are_fitted_is_not_said_to_lack_a_name(quicker: float, unnamed: tuple[str, ...]) -> None:
    """The name was linearised where its wave has another phase: what that leaves looks like a curve, until the name is fitted."""
    model = waves.Waves(slow=6.0, quicker=quicker)
    aside = replace(waves.term(model, waves.BASE), columns=np.sin((waves.AT + 25.0) / 30.0)[:, None])
    curve = np.column_stack([np.cos(waves.AT / 30.0), waves.SHAPES["quicker"]])
    unknown = Candidate("position", "piston", "position", (), ((),), kind=Kind.UNKNOWN)
    term = Term(unknown, curve, np.full(2, 5.0), (False,) * 2, lambda sizes, before: {}, "unnamed position")
    basis = joined([("position", curve, 0.1)], waves.AT.size)
    target = -model.residual({})
    linear = Linearisation(None, {}, target, np.zeros((target.size, 0)), (aside, term))
    found = FamilySearch(ModelFits(model, (), cheap=True), LinearFamily((), (linear,)), basis).run()
    assert found.final.named == {waves.BASE.at} and tuple(one.variable for one in found.unnamed) == unnamed
    (size,) = waves.BASE.parameters
    assert found.final.fit.values[size] == pytest.approx(6.0, abs=0.3)


def test_a_wave_of_the_wrong_sign_is_no_effect_of_one_sign() -> None:
    model = waves.Waves(slow=-3.0)
    assert searched(model, waves.term(model, waves.BASE, one_sided=True)).final.candidates == ()
    assert searched(model, waves.term(model, waves.BASE)).final.named == {waves.BASE.at}


def test_noise_bears_no_name() -> None:
    model = waves.Waves()
    found = searched(model, *(waves.term(model, each) for each in (waves.BASE, waves.OTHER, waves.candidate("flat", "level"))))
    assert found.final.candidates == () and max(found.probabilities.values(), default=0.0) < 0.5


def test_what_every_term_depends_on_is_named_where_the_family_needs_it() -> None:
    """The family looks as it does linearised with the parameter at 4; nothing else makes up for the quick wave."""
    model = waves.Waves(slow=3.0, quick=4.0)
    contact = waves.candidate("contact", "quick")
    (parameter,) = contact.parameters
    plain = waves.term(model, waves.BASE)
    residual = model.residual({parameter: 4.0})
    linear = Linearisation(contact, {parameter: 4.0}, -residual, np.zeros((residual.size, 0)), (plain,))
    found = searched(model, plain, others=(linear,))
    assert found.final.named == {waves.BASE.at, contact.at}
    assert found.final.fit.values[parameter] == pytest.approx(4.0, abs=0.3)


def test_what_a_healthy_machine_has_as_well_is_left_to_the_nuisance_parameters() -> None:
    model = waves.Waves(slow=0.5)
    (size,) = waves.BASE.parameters
    for limit, named in ((0.1, {waves.BASE.at}), (2.0, set())):
        limited = replace(waves.BASE, parameters=(replace(size, healthy_limit=limit),))
        assert searched(model, waves.term(model, limited)).final.named == named


def test_what_a_healthy_machine_has_does_not_take_the_place_of_a_finding() -> None:
    """A spring slack far away pulls like a force sensor's zero: with a stiffness that any machine has it is none, and the zero is found."""
    model = waves.Waves(slow=3.0)
    far = waves.candidate("far", "slow")
    (size,) = far.parameters
    far = replace(far, parameters=(replace(size, healthy_limit=5.0),), prevalence=0.2)
    found = searched(model, waves.term(model, far), waves.term(model, waves.BASE))
    assert found.probabilities[far.at] > found.probabilities[waves.BASE.at]
    assert found.final.named == {waves.BASE.at}


@pytest.mark.parametrize(("prior", "named", "undecided"), [(0.7, False, True), (0.2, True, False), (2.0, False, False)])
def test_a_probable_name_that_a_nuisance_parameter_stands_in_for_is_not_passed_over(prior: float, named: bool, undecided: bool) -> None:
    """A nuisance parameter that must move by three standard deviations leaves a name neither sure nor out of the question."""
    model = waves.Waves(slow=2.2)
    model._error *= 0.9  # what is left is noise and no more
    zero, base = waves.parameter("zero", "slow", (0.0, prior)), replace(waves.BASE, prevalence=0.5)
    nominal = model.residual({})
    background = (model.residual({zero: prior}) - nominal)[:, None]
    plain = Linearisation(None, {}, -nominal, background, (waves.term(model, base),))
    found = FamilySearch(ModelFits(model, (zero,), cheap=True), LinearFamily((zero,), (plain,)), joined([], nominal.size)).run()
    assert bool(found.final.candidates) == named
    assert [one.at for one in found.undecided] == [base.at] * undecided
