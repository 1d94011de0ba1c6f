"""What is left of an error, and of changes of it, once all that a fitted model leaves free is refitted along its derivatives."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.prior_terms import prior_terms

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cleared:
    """The part of the residual's space that nothing free reaches; the priors' residuals are rows of it.

    Attributes:
        basis: Orthonormal, of what is free, shape (n + m, p), n rows of the model and m of priors.
        left: The residual beyond it, shape (n + m,).
    """

    basis: Array
    left: Array

    @classmethod
    def of(cls, fit: Fit, replaced: Collection[tuple[str, str]] = ()) -> Cleared:
        """Return what a fit leaves; parameters at a bound are not free, nor are those of `replaced` slots, which something stands for."""
        rows, jacobian = prior_terms(fit.parameters, fit.values)
        strength = math.sqrt(fit.prior_weight)
        raw = np.concatenate([fit.residual, strength * rows])
        free = [j for j, q in enumerate(fit.parameters) if q.low < fit.values[q] < q.high and q.slot not in replaced]
        if not free:
            return cls(np.zeros((raw.size, 0)), raw)
        basis = np.linalg.qr(np.vstack([fit.jacobian, strength * jacobian])[:, free])[0]
        return cls(basis, raw - basis @ (basis.T @ raw))

    def clear(self, change: Array) -> Array:
        """Return a change of the residual, shape (n,), clear of what is free, shape (n + m,)."""
        whole = np.concatenate([change, np.zeros(self.left.size - change.size)])
        return whole - self.basis @ (self.basis.T @ whole)
