"""Fits beside a discrepancy: the marginal likelihood in closed form, and numbers that a discrepancy does not bend."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis, joined
from exo_sim.diagnosis.selection.linear_evidence import Spreads
from exo_sim.diagnosis.selection.marginal_fit import BesideDiscrepancy, MarginalFits
from exo_sim.diagnosis.selection.model_fits import ModelFits

#: A smooth error of a law that goes partly along with the slow wave.
BENT = np.sin(waves.AT / 30.0) * (waves.AT > 200.0)


def basis(columns: np.ndarray) -> DiscrepancyBasis:
    return joined([("place", columns, 3.0)], len(columns))


def test_the_square_is_that_of_the_whole_covariance() -> None:
    model = waves.Waves(slow=2.0)
    columns = np.random.default_rng(1).standard_normal((waves.AT.size, 5))
    spreads, tau = Spreads(1.5, (0.7,)), 3.0
    beside = BesideDiscrepancy(model, basis(columns), spreads, tau)
    covariance = 1.5**2 * (np.eye(waves.AT.size) + 0.7**2 * columns @ columns.T / (tau * 1.5**2))
    plain = model.residual({})
    assert float(np.sum(beside.residual({}) ** 2)) == pytest.approx(float(plain @ np.linalg.solve(covariance, plain)))
    assert beside.size == model.size and beside.discrepancy_bound == model.discrepancy_bound / 1.5


def test_a_discrepancy_does_not_bend_a_number_where_it_is_integrated_out() -> None:
    model = waves.Waves(slow=3.0)
    model._error = model._error - 4.0 * BENT
    fits = ModelFits(model, (), cheap=True)
    (size,) = waves.BASE.parameters
    plain = fits.fit((waves.BASE,))
    beside = MarginalFits(fits, basis(BENT[:, None]), Spreads(1.0, (5.0,)), 1.0)
    found = beside.fit((waves.BASE,), refined=True)
    assert plain.fit.values[size] == pytest.approx(5.0, abs=0.3)
    assert found.fit.values[size] == pytest.approx(3.0, abs=0.3)
    np.testing.assert_allclose(found.fit.residual, model.residual(found.fit.values))
    errors = beside.beside.standard_errors(beside.beside.fit((waves.BASE,), found))
    assert 0.07 < errors[size] < 0.2  # 0.07: without a discrepancy, from white noise of size 1
