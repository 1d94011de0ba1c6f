"""What is missing without a name, whether a subset holds it or leaves it to its discrepancy."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation, Term
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.linear_evidence import Spreads, Subset
from exo_sim.diagnosis.selection.nonparametric_terms import nonparametric_terms, unnamed
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing, Weighed

SHAPE = np.sin(waves.AT / 9.0)
UNKNOWN = Candidate("position", "piston", "position", (), ((),), kind=Kind.UNKNOWN)
TERM = Term(UNKNOWN, SHAPE[:, None], np.array([5.0]), (False,), lambda sizes, before: {}, "unnamed position")
BASIS = joined([("position", SHAPE[:, None], 1.0)], SHAPE.size)


def found(size: float, subset: Subset, amplitude: float) -> list[tuple[str, float]]:
    """Return the unnamed of a subset that was weighed with this amplitude of its discrepancy, and their shares."""
    target = size * SHAPE + np.random.default_rng(4).standard_normal(SHAPE.size)
    linear = Linearisation(None, {}, target, np.zeros((SHAPE.size, 0)), (TERM,))
    weighing = SubsetWeighing(LinearFamily((), (linear,)), BASIS, np.arange(SHAPE.size))
    best = Weighed(0, subset, 0.0, Spreads(1.0, (amplitude,)))
    return [(one.variable, one.share) for one in unnamed(weighing, BASIS, best, [best], weighing.posterior(best))]


def test_a_term_of_the_subset_stands_with_its_share() -> None:
    ((variable, share),) = found(3.0, (0,), 0.1)
    assert variable == "position" and share == pytest.approx(0.9, abs=0.1)


def test_a_discrepancy_that_hardly_any_healthy_machine_has_stands_too() -> None:
    ((variable, share),) = found(3.0, (), 3.0)
    assert variable == "position" and share == pytest.approx(0.9, abs=0.1)


def test_one_that_healthy_machines_have_does_not() -> None:
    assert found(1.5, (), 2.0) == [] and found(0.0, (), 0.01) == []


def test_sizes_are_counted_over_all_terms() -> None:
    wide = Term(waves.OTHER, np.zeros((SHAPE.size, 2)), np.ones(2), (False, False), lambda sizes, before: {}, "wide")
    assert [(first, term.candidate) for first, term in nonparametric_terms([wide, TERM])] == [(2, UNKNOWN)]
