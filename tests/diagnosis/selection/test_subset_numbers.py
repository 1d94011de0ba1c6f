"""What a weighed subset says of its parameters: where a fit begins, how well that is known, and what other laws would say."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation
from exo_sim.diagnosis.selection.subset_numbers import laws_of, values_and_errors
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing

(SIZE,) = waves.BASE.parameters


def weighing_of(model: waves.Waves, *candidates: Candidate) -> SubsetWeighing:
    target = -model.residual({})
    terms = tuple(waves.term(model, candidate) for candidate in candidates)
    linear = Linearisation(None, {}, target, np.zeros((target.size, 0)), terms)
    return SubsetWeighing(LinearFamily((), (linear,)), joined([], target.size), model.blocks)


def test_a_fit_begins_at_the_posterior_and_within_the_bounds() -> None:
    """The error of a wave's size is that of regression: the noise over the root of its sum of squares."""
    for size, start in ((3.0, 3.0), (14.0, 10.0)):
        model = waves.Waves(slow=size)
        weighing = weighing_of(model, waves.BASE)
        best = weighing.finalists()[0]
        values, errors = values_and_errors(weighing, (), best, weighing.posterior(best))
        assert values[SIZE] == pytest.approx(start, abs=0.3)
        assert errors[SIZE] == pytest.approx(1.0 / np.linalg.norm(waves.SHAPES["slow"]), rel=0.15)


def test_nuisance_parameters_that_the_family_lacks_stay_where_they_start() -> None:
    model = waves.Waves(slow=3.0)
    weighing = weighing_of(model, waves.BASE)
    best, other = weighing.finalists()[0], waves.parameter("zero", "level", (0.5, 1.0))
    values, errors = values_and_errors(weighing, (other,), best, weighing.posterior(best))
    assert values[other] == other.start and other not in errors


def test_a_number_is_known_no_better_than_the_effects_beside_it() -> None:
    """What is beside the slow wave is quick, or quick and a little slow, and nothing tells which: the slow one is 3 or 2.2."""
    model = waves.Waves(shapes={**waves.SHAPES, "tilted": waves.SHAPES["quick"] + 0.4 * waves.SHAPES["slow"]}, slow=3.0, quick=2.0)
    weighing = weighing_of(model, waves.BASE, waves.candidate("plain", "quick"), waves.candidate("leaning", "tilted"))
    finalists = weighing.finalists()
    laws = [(law.weight, law.values[SIZE]) for law in laws_of(weighing, (), finalists[0], finalists) if SIZE in law.errors]
    assert {round(value) for weight, value in laws if weight > 0.5} == {2, 3} and min(weight for weight, _ in laws) > 0.0
