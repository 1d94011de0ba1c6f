"""A recording that ends at rest tests nothing of what moved before, and its owner is told."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis import waves

from exo_sim.diagnosis.outcome.untested_balances import untested_balances
from exo_sim.diagnosis.policy.validation import LEAST_INFLUENCE
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.search import Search


@pytest.mark.parametrize(("change", "said"), [(0.5 * LEAST_INFLUENCE, True), (2.0 * LEAST_INFLUENCE, False)])
def test_it_is_said_where_no_prediction_changes_with_what_was_found(change: float, said: bool) -> None:
    model = waves.Waves(slow=3.0)
    search = Search(model, (), [waves.BASE], cheap=True)
    one = decide("piston", model, search.fits, search.run())
    remarks = untested_balances([one], {"base@piston": change})
    assert [remark.startswith("sum of waves of piston: ") for remark in remarks] == [True] * said
    assert untested_balances([one], {}) == untested_balances([replace(one, findings=())], {"base@piston": change}) == []
