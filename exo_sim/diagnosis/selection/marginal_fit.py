"""Fits beside a discrepancy: what every model gets wrong is integrated out, so that it biases no number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.least_squares import differences
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel
from exo_sim.diagnosis.selection.linear_evidence import Spreads
from exo_sim.diagnosis.selection.model_fits import ModelFits

Array = NDArray[np.float64]


class BesideDiscrepancy:
    """A least-squares problem whose residual has the discrepancy integrated out.

    With D H D' the covariance of the discrepancy and tau sigma^2 that of a row, the residual r becomes (I + D H D'/(tau sigma^2))^(-1/2)
    r / sigma: its square is twice the negative logarithm of the marginal likelihood, up to a constant.

    Args:
        model: The subsystem.
        basis: Of its discrepancy.
        spreads: Noise and amplitudes.
        correlation_time: Of the rows, tau.
    """

    def __init__(self, model: LeastSquaresModel, basis: DiscrepancyBasis, spreads: Spreads, correlation_time: float):
        self.model, self._noise = model, spreads.noise
        amplitudes = np.array(spreads.amplitudes)[basis.kinds] if basis.columns.shape[1] else np.zeros(0)
        scaled = basis.columns * amplitudes / (spreads.noise * np.sqrt(correlation_time))
        self._directions, sizes, _ = np.linalg.svd(scaled, full_matrices=False)
        self._taken = 1.0 - 1.0 / np.sqrt(1.0 + sizes**2)

    @property
    def blocks(self) -> NDArray[np.int64]:
        """Block of time of each row, shape (size,)."""
        return self.model.blocks

    @property
    def size(self) -> int:
        """Number of rows."""
        return self.model.size

    @property
    def discrepancy_bound(self) -> float:
        """As the subsystem's, in units of the noise that was estimated."""
        return self.model.discrepancy_bound / self._noise

    def residual(self, values: dict[FreeParameter, float], fixed: Sequence[tuple[FreeParameter, float]] = ()) -> Array:
        """Return the residual with the discrepancy integrated out, shape (size,)."""
        plain = self.model.residual(values, fixed)
        return (plain - self._directions @ (self._taken * (self._directions.T @ plain))) / self._noise


class MarginalFits:
    """Fits beside a discrepancy, stated as fits of the subsystem itself.

    Args:
        fits: Fits of the subsystem.
        basis, spreads, correlation_time: As of `BesideDiscrepancy`.
    """

    def __init__(self, fits: ModelFits, basis: DiscrepancyBasis, spreads: Spreads, correlation_time: float):
        self.plain = fits
        self._model, self._correlation_time = BesideDiscrepancy(fits.model, basis, spreads, correlation_time), correlation_time
        self.beside = ModelFits(self._model, fits.nuisances, fits.threads, fits.cheap, fits.is_spent)

    def fit(
        self, candidates: Sequence[Candidate], near: FittedModel | None = None, refined: bool = False, again: bool = False
    ) -> FittedModel:
        """Return a fit of these candidates, with the residual and the Jacobian of the subsystem; `again` as of `ModelFits.fit`."""
        found = self.beside.fit(candidates, near, again)
        if refined:
            found = self.beside.refined(found)
        return self._as_plain(found)

    def deficit(self, one: FittedModel, other: FittedModel) -> float:
        """Return by how much one model's marginal log-likelihood, its priors included, is lower than another's."""
        return self._cost(one) - self._cost(other)

    def _cost(self, fitted: FittedModel) -> float:
        """Return the negative logarithm of a model's marginal likelihood and priors, up to a constant."""
        left = self._model.residual(fitted.fit.values, fitted.fixed)
        return 0.5 * (float(left @ left) / self._correlation_time + fitted.fit.penalty)

    def _as_plain(self, fitted: FittedModel) -> FittedModel:
        fixed = [pair for candidate in fitted.candidates for pair in candidate.fixed]

        def residual(values: dict[FreeParameter, float]) -> Array:
            return self.plain.model.residual(values, fixed)

        done, base = fitted.fit, residual(fitted.fit.values)
        jacobian = differences(residual, done.parameters, done.values, base, self.plain.threads)
        return FittedModel(fitted.candidates, replace(done, residual=base, jacobian=jacobian))
