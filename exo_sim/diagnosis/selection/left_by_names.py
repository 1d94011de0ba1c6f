"""Whether names that were fitted as they act leave anything to functions that have no name."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.linear_family import LinearFamily, Linearisation, Term
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing

Array = NDArray[np.float64]


def leave_nothing(
    fit: Fit, terms: tuple[Term, ...], basis: DiscrepancyBasis, blocks: NDArray[np.int64], whole: float, is_spent: IsSpent = never
) -> bool:  # fmt: skip
    """Return whether the most probable account of what a fit leaves has none of these terms, and no more than a healthy machine's.

    They are weighed beside the numbers of the fit, which may move with them, and beside the discrepancy.

    Args:
        fit: Of the names, without discrepancy.
        terms: Functions without a name.
        basis: Of the discrepancy.
        blocks: Block of time of each row.
        whole: Size of all that effects stand for, in units of the noise of a row: an effect's number is unknown by so much.
        is_spent: Whether the time is up.
    """
    background = fit.jacobian * _spreads(fit, max(whole, 1.0))
    rest = LinearFamily((), (Linearisation(None, {}, -fit.residual, background, terms),), whole)
    best = SubsetWeighing(rest, basis, blocks, is_spent=is_spent).finalists()[0]
    asked = {term.candidate.form for term in terms}
    ratios = np.array(best.spreads.amplitudes) / basis.healthy
    beyond = any(ratio > acceptance.CERTAIN for name, ratio in zip(basis.names, ratios, strict=True) if name in asked)
    return best.subset == () and not beyond


def _spreads(fit: Fit, whole: float) -> Array:
    """Return the standard deviation of the prior of each coordinate of a fit, shape (p,); without one, as much as moves it by the whole."""
    known = np.sqrt(np.sum(fit.prior_jacobian**2, axis=0)) if fit.prior_jacobian.size else np.zeros(len(fit.parameters))
    moves = np.sqrt(np.mean(fit.jacobian**2, axis=0)) if fit.jacobian.size else np.zeros(len(fit.parameters))
    free = whole / np.maximum(moves, 1e-300)
    return np.where(known > 0.0, 1.0 / np.maximum(known, 1e-300), np.where(moves > 0.0, free, 0.0))
