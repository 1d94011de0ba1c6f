"""What takes an effect's place in other subsets, what counts as the same, and what came next."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation, Term
from exo_sim.diagnosis.policy.verdicts import AS_GOOD
from exo_sim.diagnosis.selection.family_rivals import equivalents, equivalents_of, rivals, runners_up
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing


def weighing_of(model: waves.Waves, *terms: Term) -> SubsetWeighing:
    target = -model.residual({})
    linear = Linearisation(None, {}, target, np.zeros((target.size, 0)), terms)
    return SubsetWeighing(LinearFamily((), (linear,)), joined([], target.size), model.blocks)


def test_what_does_alone_what_two_do_together_is_the_rival_of_both() -> None:
    """Drag and dry friction slow a swing nearly as damping alone does: neither is dropped because that might do for both."""
    one_wave, other_wave = waves.SHAPES["slow"], waves.SHAPES["quick"]
    shapes = {"one": one_wave, "two": other_wave, "both": one_wave + other_wave + 0.3 * waves.SHAPES["quicker"]}
    model = waves.Waves(shapes=shapes, one=2.0, two=1.4)
    one, two, both = (waves.candidate(name, name) for name in shapes)
    weighing = weighing_of(model, *(waves.term(model, each) for each in (one, two, both)))
    finalists = weighing.finalists()
    assert {c.at for c in weighing.candidates(finalists[0])} == {one.at, two.at}
    taking = rivals(weighing, finalists[0], finalists)
    assert all(both.at in {rival.at for rival, _ in taking[candidate.key]} for candidate in (one, two))


def test_a_twin_is_an_equivalent_and_a_poor_rival_is_none() -> None:
    """A twin fits as well; the quicker wave stands in the effect's place in some subset too, and is far less probable."""
    model = waves.Waves(slow=3.0)
    twin = waves.candidate("twin", "slow")
    weighing = weighing_of(model, *(waves.term(model, each) for each in (waves.BASE, twin, waves.OTHER)))
    finalists = weighing.finalists()
    best = finalists[0]
    (named,) = weighing.candidates(best)
    taking = rivals(weighing, best, finalists)
    worse = {rival.at: by for rival, by in taking[named.key]}
    assert {named.at, *worse} >= {waves.BASE.at, twin.at} and worse.get(waves.OTHER.at, 1e9) > AS_GOOD
    found = equivalents(weighing, best, taking)
    assert found == {named.at: {waves.BASE.at, twin.at}}
    assert equivalents_of(twin, found) == {waves.BASE.at, twin.at} and equivalents_of(waves.OTHER, found) == {waves.OTHER.at}


def test_laws_of_one_group_are_equivalents_whatever_they_explain() -> None:
    model = waves.Waves(slow=3.0)
    richer = waves.candidate("richer", "slow", "level")
    weighing = weighing_of(model, waves.term(model, waves.BASE, "base"), waves.term(model, richer, "base"))
    best = weighing.finalists()[0]
    assert equivalents(weighing, best, rivals(weighing, best, [best])) == {waves.BASE.at: {waves.BASE.at, richer.at}}


def test_who_came_next_is_who_would_explain_most_of_what_is_left() -> None:
    model = waves.Waves(slow=3.0, quicker=0.15, level=0.02)
    flat = waves.candidate("flat", "level")
    weighing = weighing_of(model, *(waves.term(model, each) for each in (waves.BASE, flat, waves.OTHER)))
    best = next(one for one in weighing.finalists() if {c.at for c in weighing.candidates(one)} == {waves.BASE.at})
    found = runners_up(weighing, best, weighing.posterior(best))
    assert [candidate.at for candidate, _ in found] == [waves.OTHER.at, flat.at]
    left = weighing.posterior(best).left
    explained = 1.0 - float(np.sum((left - waves.SHAPES["quicker"] * (waves.SHAPES["quicker"] @ left) / 200.0) ** 2)) / float(left @ left)
    assert found[0][1] == pytest.approx(explained, rel=0.2)
