"""Terms of laws: what adds to a balance, and has a shape or not, about a contact that slides."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from diagnosis import motion_runs
from diagnosis.motion_runs import VELOCITY

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.subsystems.motion.law_terms import DIPS, LawTerms
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.scales import MotionScales


def brake(coefficient: FreeParameter, speed: FreeParameter, values: Mapping[FreeParameter, float]) -> np.ndarray:
    """Return the drag of an eddy-current brake: a law that adds to a balance and has a shape, of which nothing in the package knows."""
    v = values.get(speed, 0.0)  # nil where the effect is off, and then it brakes nothing
    return values.get(coefficient, 0.0) * VELOCITY * v**2 / (v**2 + VELOCITY**2 + 1e-12)


@pytest.mark.parametrize(("shows", "count"), [(True, DIPS), (False, 0)])
def test_a_law_from_outside_may_have_a_shape_that_shows_beside_its_size_alone(shows: bool, count: int) -> None:
    coefficient, speed = (
        FreeParameter("eddy_brake", "slide", name, unit, Target.CYLINDER, 1.0, low, 1e4)
        for name, unit, low in (("coefficient", "N s/m", 0.0), ("speed", "m/s", 1e-3))
    )
    law = Candidate("eddy_brake", "slide", "coefficient+speed", (coefficient, speed), ((100.0, 0.1),))
    model = MotionModel([motion_runs.balance(30.0 * VELOCITY, 0.3)], motion_runs.plant(), Split({}))

    def residual(values: dict[FreeParameter, float]) -> np.ndarray:
        return -brake(coefficient, speed, values if shows else {coefficient: values.get(coefficient, 0.0)})

    terms = LawTerms(model, (), (law,), MotionScales.of(model)).terms(law, residual)
    assert len(terms) == count
    for term in terms:
        found = term.parameters(np.array([50.0]), {})
        assert found[coefficient] == 50.0 and term.alternatives == DIPS and term.one_sided == (True,)
        np.testing.assert_allclose(50.0 * term.columns[:, 0], residual(found), rtol=1e-9, atol=1e-9)
    speeds = [term.parameters(np.array([1.0]), {})[speed] for term in terms]
    assert speeds == sorted(set(speeds))
