"""Bounded least squares with priors, by a damped Gauss-Newton method on finite differences wide enough for jerky answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.quantity import Quantity
from exo_sim.diagnosis.threads import ALONE, Threads

Array = NDArray[np.float64]

#: Fewer rows than this cannot be asked anything.
FEWEST_ROWS = 30
#: A fit whose squared error is below this, in units of the noise, is not differenced anew before it ends.
NEAR_NOISE = 2.0
#: No step changes a logarithm by more than this.
FARTHEST = 1.2
#: What an error that is no number counts as, in units of the noise.
WORST = 1e4
Residual = Callable[[dict[Quantity, float]], Array]


@dataclass
class Fit:
    """A least-squares fit.

    Attributes:
        quantities: What was free.
        values: Where it ended.
        residual: Whitened residual there, shape (n,).
        jacobian: d residual / d coordinate of each quantity, shape (n, p).
        penalty: Sum of squares of what the priors say against it.
        prior_rows: Jacobian of the priors, shape (m, p).
        weight: What a prior counted against the residual's squares.
    """

    quantities: tuple[Quantity, ...]
    values: dict[Quantity, float]
    residual: Array
    jacobian: Array
    penalty: float = 0.0
    prior_rows: Array = field(default_factory=lambda: np.zeros((0, 0)))
    weight: float = 1.0

    @property
    def sse(self) -> float:
        """Sum of squares of the residual alone."""
        return float(self.residual @ self.residual)


def prior_terms(quantities: Sequence[Quantity], values: dict[Quantity, float]) -> tuple[Array, Array]:
    """Return the residuals of the priors, shape (m,), and their Jacobian in coordinates, shape (m, p)."""
    rows, jac = [], []
    for j, quantity in enumerate(quantities):
        if quantity.prior is not None:
            mean, spread = quantity.prior
            rows.append((values[quantity] - mean) / spread)
            row = np.zeros(len(quantities))
            row[j] = quantity.slope(values[quantity]) / spread
            jac.append(row)
    return np.array(rows), np.array(jac).reshape(len(rows), len(quantities))


def differences(
    residual: Residual,
    quantities: Sequence[Quantity],
    values: dict[Quantity, float],
    base: Array,
    threads: Threads = ALONE,
) -> Array:
    """Return the Jacobian by one-sided differences in coordinates, shape (n, p)."""

    def column(quantity: Quantity) -> Array:
        share = 0.1 if quantity.rough else 0.02
        if quantity.wide:
            step = share * max(values[quantity], 1e-12 * quantity.scale)
        else:
            step = share * max(quantity.scale, abs(values[quantity] - quantity.neutral))
        if values[quantity] + step > quantity.high:
            step = -step
        there = values[quantity] + step
        moved = residual({**values, quantity: there})
        apart = quantity.coordinate(there) - quantity.coordinate(values[quantity])
        column = (moved - base) / apart
        return column if np.isfinite(column).all() else np.zeros_like(base)

    columns = threads.predictions(column, quantities)
    return np.column_stack(columns) if columns else np.zeros((base.size, 0))


def fit(
    residual: Residual,
    quantities: Sequence[Quantity],
    start: dict[Quantity, float],
    threads: Threads = ALONE,
    most: int = 8,
    tolerance: float = 2e-3,
    spell: float = 1.0,
    known: Mapping[Quantity, Array] | None = None,
    exact: bool = False,
) -> Fit:
    """Minimise the whitened residual plus priors inside the bounds.

    While a model misses more than the noise, its errors are counted in units of what it misses, and neighbours that say the same
    count once: else the first wrong model bends every believed number as far as it goes, and the search is lost from there.

    Args:
        residual: Values to a whitened residual, shape (n,).
        quantities: What is free, p of them.
        start: Where to begin.
        threads: Threads for the finite differences.
        most: The most iterations.
        tolerance: Stop when the cost falls by less than this share.
        spell: How many neighbouring rows say the same.
        known: Columns of the Jacobian near the start, by quantity; then it is carried on by Broyden's update instead of being
            differenced anew at every step.
        exact: Whether the Jacobian is differenced anew where the fit ends.
    """
    quantities = tuple(quantities)
    values = {q: float(np.clip(start[q], q.low, q.high)) for q in quantities}
    r = residual(values)
    rows, row_jac = prior_terms(quantities, values)
    if not quantities or not np.isfinite(r).all():
        r = np.where(np.isfinite(r), r, WORST)
        return Fit(quantities, values, r, np.zeros((r.size, len(quantities))), float(rows @ rows), row_jac)
    missing = [q for q in quantities if known is None or q not in known]
    jac = np.zeros((r.size, len(quantities)))
    for j, column in zip([quantities.index(q) for q in missing], differences(residual, missing, values, r, threads).T, strict=True):
        jac[:, j] = column
    for j, q in enumerate(quantities):
        if known is not None and q in known:
            jac[:, j] = known[q]
    fresh = known is None
    damping = 1e-4
    weight = 1.0
    for _ in range(most):
        weight = spell * max(float(r @ r) / max(r.size, 1), 1.0)
        cost = float(r @ r + weight * (rows @ rows))
        whole = np.vstack([jac, math.sqrt(weight) * row_jac])
        gradient = whole.T @ np.concatenate([r, math.sqrt(weight) * rows])
        normal = whole.T @ whole
        improved = False
        for attempt in range(5):
            step = _bounded_step(normal, gradient, damping, quantities, values, FARTHEST / 3.0**attempt)
            trial = {q: q.value(q.coordinate(values[q]) + float(s)) for q, s in zip(quantities, step, strict=True)}
            new = residual(trial)
            new_rows, _ = prior_terms(quantities, trial)
            new_cost = float(new @ new + weight * (new_rows @ new_rows))
            if np.isfinite(new_cost) and new_cost < cost:
                improved = True
                break
            damping = max(damping * 10.0, 1e-3)
        if not improved:
            if fresh:
                break
            jac, fresh, damping = differences(residual, quantities, values, r, threads), True, 1e-4
            continue
        gain = (cost - new_cost) / max(cost, 1e-300)
        taken = np.array([q.coordinate(trial[q]) - q.coordinate(values[q]) for q in quantities])
        surprise = new - r - jac @ taken
        values, r, rows = trial, new, new_rows
        damping = max(damping * 0.2, 1e-6)
        if gain < tolerance:
            if fresh or float(r @ r) < NEAR_NOISE * r.size:
                break
            jac, fresh, damping = differences(residual, quantities, values, r, threads), True, 1e-4
        elif known is None:
            jac = differences(residual, quantities, values, r, threads)
        else:
            jac, fresh = jac + np.outer(surprise, taken) / max(float(taken @ taken), 1e-300), False
    if exact and not fresh:
        jac = differences(residual, quantities, values, r, threads)
    return Fit(quantities, values, r, jac, float(rows @ rows), row_jac, weight)


def _bounded_step(
    normal: Array, gradient: Array, damping: float, quantities: Sequence[Quantity], values: dict[Quantity, float], farthest: float
) -> Array:
    """Return a damped Newton step in coordinates; what would leave its bounds is held there and the rest solved anew.

    No logarithm moves by more than `farthest`.
    """
    p = len(quantities)
    free = np.ones(p, dtype=bool)
    step = np.zeros(p)
    low = np.array([q.coordinate(q.low) - q.coordinate(values[q]) for q in quantities])
    high = np.array([q.coordinate(q.high) - q.coordinate(values[q]) for q in quantities])
    wide = np.array([q.wide for q in quantities])
    low, high = np.where(wide, np.maximum(low, -farthest), low), np.where(wide, np.minimum(high, farthest), high)
    damped = normal + damping * np.diag(np.diag(normal) + 1e-12)
    for _ in range(p + 1):
        if not free.any():
            break
        right = -gradient[free] - damped[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.lstsq(damped[np.ix_(free, free)], right, rcond=None)[0]
        out = free & ((step < low - 1e-12) | (step > high + 1e-12))
        if not out.any():
            break
        step[out] = np.clip(step[out], low[out], high[out])
        free &= ~out
    return np.clip(step, low, high)
