"""Priors as residuals: a number in which something else may be counted is held against the nearer of two beliefs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.estimation.prior_terms import as_counted, prior_terms

DEAD = FreeParameter("dead_volume", "piston", "dead_volume_1", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.15), neutral=1.0)
HOSE = FreeParameter(
    "line_restriction", "piston", "volume", "m^3", Target.CYLINDER, 1e-5, 1e-7, 1e-3, logarithmic=True, displaces=((DEAD.key, 1e5),)
)
BIAS = FreeParameter("sensor_zero", "piston", "pressure_1.bias", "Pa", Target.SENSOR, 500.0, -1e4, 1e4, (0.0, 500.0))


@pytest.mark.parametrize(
    ("dead", "hose", "away", "counted"),
    [
        (0.2, 8e-6, 0.0, 1.0),  # all of it in the dead volume
        (0.25, 9e-6, 1.0, 1.15),
        (1.0, 8e-6, 0.0, 1.0),  # all of it on top
        (1.15, 8e-6, 1.0, 1.15),
        (0.9, 8e-6, -0.1 / 0.15, 0.9),  # nearer without
    ],
)
def test_a_dead_volume_is_held_against_what_is_believed_with_the_hose_and_without(
    dead: float, hose: float, away: float, counted: float
) -> None:
    values = {DEAD: dead, HOSE: hose}
    rows, _ = prior_terms((DEAD, HOSE), values)
    assert rows == pytest.approx([away], abs=1e-12)
    assert as_counted(DEAD, values) == pytest.approx(counted)


def test_without_a_hose_that_is_free_a_dead_volume_is_what_it_is() -> None:
    rows, jacobian = prior_terms((DEAD, BIAS), {DEAD: 0.7, BIAS: 250.0})
    assert rows == pytest.approx([-2.0, 0.5])
    assert jacobian == pytest.approx(np.diag([DEAD.scale / 0.15, 1.0]))
    assert as_counted(DEAD, {DEAD: 0.7}) == 0.7


@given(dead=st.floats(0.06, 2.0), hose=st.floats(2e-7, 5e-5))
def test_the_jacobian_is_that_of_the_rows(dead: float, hose: float) -> None:
    parameters, values = (DEAD, HOSE, BIAS), {DEAD: dead, HOSE: hose, BIAS: 100.0}
    _, jacobian = prior_terms(parameters, values)
    for j, q in enumerate(parameters):
        step = 1e-6
        ends = [prior_terms(parameters, {**values, q: q.value(q.coordinate(values[q]) + sign * step)})[0] for sign in (-1.0, 1.0)]
        near = [as_counted(DEAD, {**values, q: q.value(q.coordinate(values[q]) + sign * step)}) for sign in (-1.0, 1.0)]
        if abs(near[1] - near[0]) < 1e-3:  # not at the kink
            assert (ends[1] - ends[0]) / (2.0 * step) == pytest.approx(jacobian[:, j], rel=1e-3, abs=1e-4)
