"""Pruning of many effects at once: what each one's absence would leave, weighed together in closed form.

One prediction without an effect gives the change s_g of the residual that its absence brings, exactly; what the other parameters can do
about it is taken from the Jacobian of the fit. For a set R of effects that are left out,

    r_R = r + sum_(g in R) s_g + J d

whitened as in `joint_proposal`, d those parameters that stay. Effects go one by one, the least missed first, while the remaining set
becomes more probable (Schwarz's price of its parameters, and the prior odds of its effects).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.noise_model import noise_model
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.selection.evidence import price_of_parameter
from exo_sim.diagnosis.selection.fitted_model import FittedModel, LeastSquaresModel

Array = NDArray[np.float64]


def jointly_pruned(model: LeastSquaresModel, now: FittedModel, threads: Threads = SERIAL) -> tuple[Candidate, ...]:
    """Return the candidates of a fitted model that are worth their parameters beside each other.

    Args:
        model: The subsystem.
        now: The model, with the Jacobian at its values.
        threads: Threads for the predictions.
    """
    base, parameters = now.fit.residual, now.fit.parameters

    def absence(candidate: Candidate) -> Array:
        left = now.without(candidate)
        values = {q: v for q, v in now.fit.values.items() if q not in candidate.parameters}
        change = model.residual(values, [pair for one in left for pair in one.fixed]) - base
        return np.asarray(change) if np.isfinite(change).all() else np.full_like(base, 1e3)

    if not now.candidates:
        return ()
    changes = threads.predictions(absence, now.candidates)
    process = noise_model(base, model.blocks)
    rows, jac = prior_terms(parameters, now.fit.values)
    gram, pull = _normal_equations(
        np.vstack([process.whitened(now.fit.jacobian), jac]),
        np.vstack([process.whitened(np.column_stack([base, *changes])), _zeros_below(rows, len(changes))]),
    )
    price = price_of_parameter(base.size)
    at_bound = {q for q in parameters if not q.low < now.fit.values[q] < q.high}

    def cost(kept: tuple[Candidate, ...]) -> float:
        """Return the negative log-posterior of a set, up to a constant."""
        out = [j for j, one in enumerate(now.candidates) if one not in kept]
        gone = {q for j in out for q in now.candidates[j].parameters}
        free = [j for j, q in enumerate(parameters) if q not in gone and q not in at_bound]
        weights = np.zeros(1 + len(changes))
        weights[0], weights[[1 + j for j in out]] = 1.0, 1.0
        across = pull[free] @ weights
        left = float(weights @ gram[1] @ weights) - float(across @ np.linalg.lstsq(gram[0][np.ix_(free, free)], across, rcond=None)[0])
        return 0.5 * left + price * sum(len(c.parameters) for c in kept if not c.is_law) - sum(c.prior_log_odds for c in kept)

    kept = now.candidates
    least = cost(kept)
    while kept:
        tried = [drop_orphans(tuple(c for c in kept if c is not one)) for one in kept]
        costs = [cost(one) for one in tried]
        best = int(np.argmin(costs))
        if costs[best] >= least:
            break
        kept, least = tried[best], costs[best]
    return kept


def _zeros_below(rows: Array, count: int) -> Array:
    """Return the priors' residuals beside zeros for what no prior speaks of, shape (len(rows), 1 + count)."""
    return np.column_stack([rows.reshape(-1, 1), np.zeros((len(rows), count))])


def _normal_equations(free: Array, given: Array) -> tuple[tuple[Array, Array], Array]:
    """Return the products of columns among the free ones, among the given ones, and of the free with the given ones."""
    return (free.T @ free, given.T @ given), free.T @ given
