"""What a model misses is a curve only where one variable predicts enough of it."""

from __future__ import annotations

import numpy as np
import pytest

from exo_sim.diagnosis.discrepancy.curve import Curve
from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.policy.verdicts import LEAST_CURVE

AT = np.array([0.0, 1.0])


def missing(*explains: float) -> Discrepancy:
    return Discrepancy("force", "N", "force balance", tuple(Curve(f"v{i}", AT, AT, AT, share) for i, share in enumerate(explains)), 2.0)


def test_the_best_curve_is_the_first_if_it_predicts_enough() -> None:
    found = missing(0.9, 0.4)
    assert found.best is found.curves[0] and found.pattern == 0.9


@pytest.mark.parametrize("explains", [(), (float(LEAST_CURVE),), (-0.2,)])
def test_no_curve_where_none_predicts_enough(explains: tuple[float, ...]) -> None:
    assert missing(*explains).best is None
    assert missing(*explains).pattern == max((0.0, *explains)) or explains == (-0.2,)
