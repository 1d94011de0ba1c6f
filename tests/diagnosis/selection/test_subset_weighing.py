"""Subsets of waves, weighed in closed form: the true one first, probabilities that add up, and none without its ground."""

from __future__ import annotations

import math

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation, Term
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing

BASE, ON_TOP, OTHER = waves.BASE, waves.ON_TOP, waves.OTHER


def weighing(*candidates: Candidate, standing: tuple[str, ...] = (), **sizes: float) -> SubsetWeighing:
    model = waves.Waves(1e9, waves.SHAPES, **sizes)
    terms = tuple(
        Term(c, waves.SHAPES[c.parameters[0].parameter.split(".")[-1]][:, None], np.array([4.0]), (False,), lambda s, b: {}, c.effect)
        for c in candidates
    )
    target = -model.residual({})
    family = LinearFamily((), (Linearisation(None, {}, target, np.zeros((target.size, 0)), terms),))
    return SubsetWeighing(family, joined([], target.size), model.blocks, standing)


def test_the_waves_that_are_there_are_the_most_probable_subset() -> None:
    one = weighing(BASE, OTHER, waves.candidate("flat", "level"), slow=3.0, quicker=2.0)
    finalists = one.finalists()
    assert one.candidates(finalists[0]) == (BASE, OTHER)
    assert [f.score for f in finalists] == sorted((f.score for f in finalists), reverse=True)
    probabilities = one.probabilities(finalists)
    assert probabilities[BASE.at] > 0.99 and probabilities[OTHER.at] > 0.99 and probabilities[("flat", "piston")] < 0.3
    assert one.posterior(finalists[0]).sizes == pytest.approx([3.0, 2.0], abs=0.3)


def test_the_probability_of_any_of_two_names_for_one_wave_is_that_of_the_wave() -> None:
    twin = waves.candidate("twin", "slow")
    one = weighing(BASE, twin, slow=3.0)
    finalists = one.finalists()
    assert one.probability_of_any(finalists, {BASE.at, twin.at}) == pytest.approx(1.0)
    assert one.probability_of_any(finalists, {BASE.at}) == pytest.approx(one.probability_of_any(finalists, {twin.at}), abs=0.02)
    assert one.probability_of_any(finalists, set()) == 0.0


def test_what_comes_on_top_is_not_without_its_ground_unless_the_machine_has_it() -> None:
    alone = weighing(ON_TOP, quick=4.0)
    assert all(not one.subset and one.score > -math.inf for one in alone.finalists()[:1])
    standing = weighing(ON_TOP, standing=("base",), quick=4.0)
    assert standing.candidates(standing.finalists()[0]) == (ON_TOP,)


def test_more_terms_may_be_asked_beside_a_subset() -> None:
    one = weighing(BASE, OTHER, slow=3.0)
    best = one.finalists()[0]
    assert [term.candidate for term in one.terms(best)] == [BASE]
    assert one.posterior(best, (1,)).sizes == pytest.approx([3.0, 0.0], abs=0.3)


def test_what_a_subset_leaves_has_its_discrepancy_in_it() -> None:
    model = waves.Waves(1e9, waves.SHAPES, slow=3.0, quicker=2.0)
    target, wave = -model.residual({}), waves.SHAPES["quicker"]
    term = Term(BASE, waves.SHAPES["slow"][:, None], np.array([4.0]), (False,), lambda s, b: {}, "base")
    family = LinearFamily((), (Linearisation(None, {}, target, np.zeros((target.size, 0)), (term,)),))
    basis = joined([("time", wave[:, None], 5.0)], target.size)
    one = SubsetWeighing(family, basis, model.blocks)
    posterior = one.posterior(one.finalists()[0])
    with_it, whole = float(posterior.left @ posterior.left), target - posterior.sizes[0] * waves.SHAPES["slow"]
    assert one.square_left(posterior) == pytest.approx(float(whole @ whole)) and one.square_left(posterior) > 2.0 * with_it
