"""A recording that ends at rest tests nothing of what moved before, and its owner is told."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis import waves

from exo_sim.diagnosis.outcome.untested_balances import untested_balances
from exo_sim.diagnosis.policy.validation import LEAST_INFLUENCE
from exo_sim.diagnosis.selection.decision import decide
from exo_sim.diagnosis.selection.search import Search


@pytest.mark.parametrize(
    ("compared", "influence", "said"),
    [
        (True, {"base@piston": 0.5 * LEAST_INFLUENCE}, True),
        (True, {"base@piston": 2.0 * LEAST_INFLUENCE}, False),
        (True, {}, False),  # a lag that healthy parts of it stand in for is not left out
        (False, {}, True),
    ],
)
def test_it_is_said_where_no_prediction_changes_with_what_was_found(compared: bool, influence: dict[str, float], said: bool) -> None:
    model = waves.Waves(slow=3.0)
    search = Search(model, (), [waves.BASE], cheap=True)
    one = decide("piston", model, search.fits, search.run())
    judged = {one.key} if compared else set()
    assert [remark.startswith("sum of waves of piston: ") for remark in untested_balances([one], judged, influence)] == [True] * said
    assert untested_balances([replace(one, findings=())], judged, influence) == []
