"""What names leave of functions that have no name, weighed beside the numbers that were fitted."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import joined
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.linear_family import Term
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.selection.left_by_names import leave_nothing
from exo_sim.diagnosis.selection.model_fits import ModelFits

CURVE = np.column_stack([waves.SHAPES["quicker"], np.sin(waves.AT / 5.0)])
UNKNOWN = Candidate("position", "piston", "position", (), ((),), kind=Kind.UNKNOWN)
TERM = Term(UNKNOWN, CURVE, np.full(2, 5.0), (False, False), lambda sizes, before: {}, "unnamed position")


def is_enough(model: waves.Waves, term: Term = TERM, healthy: float = 0.2) -> bool:
    fit = ModelFits(model, (), cheap=True).fit((waves.BASE,)).fit
    return leave_nothing(fit, (term,), joined([("position", term.columns, healthy)], waves.AT.size), model.blocks, 6.0)


@pytest.mark.parametrize(("quicker", "enough"), [(0.0, True), (0.15, True), (0.6, False), (3.0, False)])
def test_a_curve_that_is_there_is_left_however_small_beside_the_name_and_what_healthy_machines_have_is_not(
    quicker: float, enough: bool
) -> None:
    assert is_enough(waves.Waves(slow=6.0, quicker=quicker)) is enough


def test_a_curve_that_the_numbers_of_the_name_may_be_is_not_left() -> None:
    """Both are the same wave: the name has it."""
    same = Term(UNKNOWN, waves.SHAPES["slow"][:, None], np.array([5.0]), (False,), lambda sizes, before: {}, "unnamed position")
    assert is_enough(waves.Waves(slow=6.0), same)
