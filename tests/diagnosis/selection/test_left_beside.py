"""What is left beside a discrepancy: nothing of what it may be, all of what it may not, and its price between the two."""

from __future__ import annotations

import math

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis, joined
from exo_sim.diagnosis.estimation.least_squares import Fit, fit
from exo_sim.diagnosis.selection.left_beside import left_beside

SLOW, QUICK = waves.SHAPES["slow"], waves.SHAPES["quick"]


def fitted(*numbers: str, **sizes: float) -> Fit:
    model = waves.Waves(1e9, waves.SHAPES, **sizes)
    free = [waves.parameter("number", name, (0.0, 1.0)) for name in numbers]
    return fit(model.residual, free, {q: 0.0 for q in free})


def basis(share: float) -> DiscrepancyBasis:
    return joined([("law", SLOW[:, None], share)], waves.AT.size)


def test_without_a_discrepancy_it_is_the_residual() -> None:
    plain = fitted(slow=6.0)
    assert left_beside(plain, joined((), waves.AT.size), 1.0) == pytest.approx(math.sqrt(plain.sse / waves.AT.size))
    empty = Fit((), {}, np.zeros(0), np.zeros((0, 0)))
    assert left_beside(empty, joined((), 0), 1.0) == 0.0


def test_what_a_discrepancy_may_be_is_not_left_and_what_it_may_not_be_is() -> None:
    assert left_beside(fitted(slow=6.0), basis(6.0), 1.0) < 1.1
    assert left_beside(fitted(slow=6.0), basis(0.01), 1.0) > 3.5
    quick = fitted(quick=6.0)
    assert left_beside(quick, basis(6.0), 1.0) == pytest.approx(math.sqrt(quick.sse / waves.AT.size), rel=0.01)


def test_the_less_a_row_is_worth_the_dearer_it_is_to_bend_a_law() -> None:
    left = [left_beside(fitted(slow=6.0), basis(1.0), worth) for worth in (1.0, 10.0, 100.0)]
    assert left == sorted(left) and left[0] < 1.2 < left[-1]


def test_numbers_of_the_rig_move_with_it_within_their_priors() -> None:
    """A number that was fitted against the misfit moves back beside the discrepancy that explains it."""
    together = SLOW + 0.5 * QUICK
    one = fitted("quick", slow=6.0, quick=3.0)
    law = joined([("law", together[:, None], 6.0)], waves.AT.size)
    assert left_beside(one, law, 1.0) < 1.15
    stiff = Fit((), {}, one.residual, np.zeros((waves.AT.size, 0)))
    assert left_beside(stiff, law, 1.0) > 1.8
