"""Where what all probable subsets share leaves too much, the subsets themselves are fitted, and the best of the fits counts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import cast

import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.policy.budgets import MOST_REFITTED
from exo_sim.diagnosis.policy.verdicts import AS_GOOD
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.linear_evidence import Spreads
from exo_sim.diagnosis.selection.marginal_fit import MarginalFits
from exo_sim.diagnosis.selection.refitted_finalists import Refitted, best_form, best_refitted, poorer_forms_first, probability_of
from exo_sim.diagnosis.selection.subset_weighing import Weighed

NAMES: Mapping[int, tuple[Candidate, ...]] = {
    0: (waves.BASE,), 1: (waves.BASE, waves.OTHER), 2: (waves.OTHER,), 3: (waves.OTHER, waves.BASE),
    **{4 + k: (waves.candidate(f"more_{k}", "level"),) for k in range(8)},
}  # fmt: skip


def subset(number: int) -> Weighed:
    return Weighed(0, (number,), -float(number), Spreads(1.0, ()))


def refit(one: Weighed, candidates: tuple[Candidate, ...]) -> Refitted:
    model = FittedModel.at({}, candidates)
    return Refitted(one, cast(MarginalFits, None), model)


def best(worth: Mapping[int, float], asked: list[int], count: int = 4) -> int:
    """Return the subset that wins if the evidence of the fit of each is so much; `asked` is filled with those that were fitted."""
    at = {frozenset(c.key for c in names): number for number, names in reversed(list(NAMES.items()))}

    def fitted(one: Weighed, candidates: tuple[Candidate, ...]) -> Refitted:
        asked.append(one.subset[0])
        return refit(one, candidates)

    def evidence(model: FittedModel) -> float:
        return worth.get(at[frozenset(c.key for c in model.candidates)], -math.inf)

    first = refit(subset(0), NAMES[0])
    found = best_refitted(first, [subset(k) for k in range(count)], lambda one: NAMES[one.subset[0]], fitted, evidence)
    return found.weighed.subset[0]


@pytest.mark.parametrize(("gain", "wins"), [(AS_GOOD + 0.1, 1), (AS_GOOD - 0.1, 0), (-5.0, 0)])
def test_another_subset_must_surpass_the_first_plainly(gain: float, wins: int) -> None:
    assert best({0: 0.0, 1: gain, 2: -50.0}, []) == wins


def test_a_set_of_names_is_fitted_once_and_only_some_are() -> None:
    asked: list[int] = []
    best({}, asked, count=len(NAMES))
    assert asked == [1, 2, 4, 5][:MOST_REFITTED]  # 0 is the first, 3 is 1 in another order


def test_a_name_is_as_probable_as_its_evidence_says() -> None:
    assert probability_of(0.0) == 0.5 and probability_of(3.0) == pytest.approx(1.0 / (1.0 + math.exp(-3.0)))
    assert probability_of(1e9) == 1.0 and probability_of(-1e9) == pytest.approx(0.0)


@pytest.mark.parametrize(("gain", "wins"), [(AS_GOOD + 0.1, 2), (AS_GOOD - 0.1, 0)])
def test_each_form_of_the_same_effects_is_fitted_once_from_the_most_probable_that_has_it(gain: float, wins: int) -> None:
    curved, plain = waves.candidate("base", "curved"), waves.candidate("base", "plain")
    forms, asked = {0: (curved,), 1: (curved,), 2: (plain,), 3: (plain,)}, []
    worth = {curved.key: 0.0, plain.key: gain}

    def fitted(one: Weighed, candidates: tuple[Candidate, ...]) -> Refitted:
        asked.append(one.subset[0])
        return refit(one, candidates)

    found = best_form(
        refit(subset(0), forms[0]), [subset(k) for k in forms], lambda one: forms[one.subset[0]], fitted,
        lambda model: worth[model.candidates[0].key],
    )  # fmt: skip
    assert asked == [2] and found.weighed.subset[0] == wins


def named_as(*effects: str) -> tuple[Candidate, ...]:
    return tuple(waves.candidate(effect, "size") for effect in effects)


@pytest.mark.parametrize(
    ("sets", "order"),
    [
        # the same effects with friction of one direction come next, whatever is more probable
        ([("asymmetric_friction", "viscous_friction"), ("asymmetric_friction",), ("coulomb_friction", "viscous_friction")], [0, 2, 1]),
        ([("asymmetric_friction", "viscous_friction"), ("coulomb_friction",)], [0, 1]),  # with less beside it they are others
        ([("coulomb_friction",), ("asymmetric_friction",), ("quadratic_drag",)], [0, 1, 2]),  # a richer form is no poorer one
        ([("asymmetric_friction",), ("quadratic_drag",), ("viscous_friction",)], [0, 1, 2]),
    ],
)
def test_the_same_effects_in_poorer_forms_are_fitted_first(sets: list[tuple[str, ...]], order: list[int]) -> None:
    subsets = [subset(k) for k in range(len(sets))]
    assert [one.subset[0] for one in poorer_forms_first(subsets, lambda one: named_as(*sets[one.subset[0]]))] == order
