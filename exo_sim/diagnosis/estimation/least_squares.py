"""Bounded least squares with priors: a damped Gauss-Newton method on finite differences that bear nonsmooth predictions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.prior_terms import prior_terms
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads

Array = NDArray[np.float64]

#: A fit whose mean square residual is below this, in units of the noise, is not differenced anew before it ends. Of 71 fits to four
#: benches and legs, the pendulum and EMPS it ended 37; of 16 of these that went on from there all the same the cost fell by 3.1 % once (8.5
#: in -2 log-likelihood, of a leg with a hose), by 0.3 % at most in the others.
NEAR_NOISE = 2.0
#: A fit that lowered its squared error by less than this since its Jacobian was differenced is not differenced anew: of 60 fits to
#: whole machine A those gained 0.1 % by it at most.
RENEWED_FOR = 0.03
#: The same where the Jacobian itself is wanted.
EXACT_FOR = 1e-5
#: A fit ends where a step lowers its cost by less than this share, unless more is asked of it.
TOLERANCE = 2e-3
#: Largest step in the logarithm of a parameter.
LARGEST_LOG_STEP = 1.2
#: So many damped steps are always tried, and up to so many in all while the linear model promises more than the tolerance. A law may bend
#: within a hundredth of what its slope asks for: of the second machine of Cantera's draw 2811282, friction of 28 N known to 0.2 N, the
#: speed at which the contact slides was to be 58 times what it was; the fit ended where it began, with a squared error of 408 for 265 rows.
SURE_ATTEMPTS, MOST_ATTEMPTS = 5, 10
#: Residual that replaces one that is not finite, in units of the noise.
WORST = 1e4
#: Values of the free parameters to a whitened residual, shape (n,).
Residual = Callable[[dict[FreeParameter, float]], Array]


@dataclass(frozen=True)
class Derivatives:
    """How a fit comes by its Jacobian.

    Attributes:
        known: Columns of the Jacobian near the start, by parameter; the Jacobian is then updated by Broyden's formula instead of being
            differenced at every step.
        differenced_at: Of the known columns, as of `Fit`.
        renewed: Whether it is differenced anew where known columns lead no further; else the fit ends there.
        exact: Whether it is differenced anew where the fit ends.
    """

    known: Mapping[FreeParameter, Array] | None = None
    differenced_at: float = math.inf
    renewed: bool = True
    exact: bool = False


@dataclass(frozen=True)
class Fit:
    """A least-squares fit.

    Attributes:
        parameters: What was free, p of them.
        values: Where it ended.
        residual: Whitened residual there, shape (n,).
        jacobian: d residual / d coordinate of each parameter, shape (n, p).
        penalty: Sum of squares of the priors' residuals.
        prior_jacobian: Jacobian of the priors' residuals, shape (m, p).
        prior_weight: Weight of the priors' squares against the residual's.
        differenced_at: Sum of squares of the residual where the Jacobian was differenced last; infinite where part of it never was.
    """

    parameters: tuple[FreeParameter, ...]
    values: dict[FreeParameter, float]
    residual: Array
    jacobian: Array
    penalty: float = 0.0
    prior_jacobian: Array = field(default_factory=lambda: np.zeros((0, 0)))
    prior_weight: float = 1.0
    differenced_at: float = math.inf

    @property
    def sse(self) -> float:
        """Sum of squares of the residual, priors left out."""
        return float(self.residual @ self.residual)

    @property
    def columns(self) -> dict[FreeParameter, Array]:
        """Columns of the Jacobian by parameter, shape (n,) each."""
        return dict(zip(self.parameters, self.jacobian.T, strict=True))


def differences(
    residual: Residual,
    parameters: Sequence[FreeParameter],
    values: dict[FreeParameter, float],
    base: Array,
    threads: Threads = SERIAL,
) -> Array:
    """Return the Jacobian by one-sided differences in coordinates, shape (n, p)."""

    def column(parameter: FreeParameter) -> Array:
        share = 0.1 if parameter.nonsmooth else 0.02
        here = values[parameter]
        if parameter.logarithmic:
            here = max(here, 1e-12 * parameter.scale)  # below it the coordinate does not change
            step = share * here
        else:
            step = share * max(parameter.scale, abs(here - parameter.neutral))
        if here + step > parameter.high:
            step = -step
        changed = residual({**values, parameter: here + step})
        apart = parameter.coordinate(here + step) - parameter.coordinate(here)
        column = (changed - base) / apart
        return column if np.isfinite(column).all() else np.zeros_like(base)

    columns = threads.predictions(column, parameters)
    return np.column_stack(columns) if columns else np.zeros((base.size, 0))


def fit(
    residual: Residual,
    parameters: Sequence[FreeParameter],
    start: Mapping[FreeParameter, float],
    threads: Threads = SERIAL,
    *,
    max_iterations: int = 8,
    tolerance: float = TOLERANCE,
    correlation_length: float = 1.0,
    derivatives: Derivatives = Derivatives(),
    is_spent: IsSpent = never,
) -> Fit:
    """Minimise r'r + w z'z inside the bounds, r the whitened residual, z that of the priors.

    The weight w of the priors is the correlation length times max(r'r / n, 1): while a model misses more than the noise its residuals
    are counted in units of what it misses, and correlated neighbours count once. Without it the first wrong model would drive every
    nuisance parameter to its bound.

    Args:
        residual: Values to a whitened residual, shape (n,).
        parameters: What is free, p of them.
        start: Initial values.
        threads: Threads for the finite differences.
        max_iterations: Largest number of Gauss-Newton steps.
        tolerance: Stop when the cost falls by less than this share.
        correlation_length: Of the residual, in rows.
        derivatives: How it comes by its Jacobian.
        is_spent: Asked before every step and every difference: the fit then ends where it is.
    """
    parameters, known, renewed, differenced_at = tuple(parameters), derivatives.known, derivatives.renewed, derivatives.differenced_at
    values = {q: float(np.clip(start[q], q.low, q.high)) for q in parameters}
    r = residual(values)
    rows, row_jac = prior_terms(parameters, values)
    if not parameters or not np.isfinite(r).all():
        r = np.where(np.isfinite(r), r, WORST)
        return Fit(parameters, values, r, np.zeros((r.size, len(parameters))), float(rows @ rows), row_jac)
    missing = [q for q in parameters if known is None or q not in known]
    jac = np.zeros((r.size, len(parameters)))
    for j, column in zip([parameters.index(q) for q in missing], differences(residual, missing, values, r, threads).T, strict=True):
        jac[:, j] = column
    for j, q in enumerate(parameters):
        if known is not None and q in known:
            jac[:, j] = known[q]
    renewed_for = EXACT_FOR if derivatives.exact else RENEWED_FOR
    if len(missing) == len(parameters):
        differenced_at = float(r @ r)
    elif missing:
        differenced_at = math.inf
    damping = 1e-4
    weight = correlation_length * max(float(r @ r) / max(r.size, 1), 1.0)

    def is_fresh() -> bool:
        """Return whether hardly anything was gained since the Jacobian was differenced."""
        return abs(differenced_at - float(r @ r)) <= renewed_for * differenced_at < math.inf

    for _ in range(max_iterations):
        if is_spent():
            break
        weight = correlation_length * max(float(r @ r) / max(r.size, 1), 1.0)
        cost = float(r @ r + weight * (rows @ rows))
        whole = np.vstack([jac, math.sqrt(weight) * row_jac])
        gradient = whole.T @ np.concatenate([r, math.sqrt(weight) * rows])
        normal = whole.T @ whole
        improved = False
        for attempt in range(MOST_ATTEMPTS):
            step = _bounded_step(normal, gradient, damping, parameters, values, LARGEST_LOG_STEP / 3.0**attempt)
            if attempt >= SURE_ATTEMPTS and not _promised(normal, gradient, step) > tolerance * cost:
                break
            tried = {q: q.value(q.coordinate(values[q]) + float(s)) for q, s in zip(parameters, step, strict=True)}
            new = residual(tried)
            new_rows, _ = prior_terms(parameters, tried)
            new_cost = float(new @ new + weight * (new_rows @ new_rows))
            if np.isfinite(new_cost) and new_cost < cost:
                improved = True
                break
            damping = max(damping * 10.0, 1e-3)
        if not improved:
            if is_fresh() or not renewed or is_spent():
                break
            jac, differenced_at, damping = differences(residual, parameters, values, r, threads), float(r @ r), 1e-4
            continue
        gain = (cost - new_cost) / max(cost, 1e-300)
        taken = np.array([q.coordinate(tried[q]) - q.coordinate(values[q]) for q in parameters])
        nonlinearity = new - r - jac @ taken
        values, r, rows = tried, new, new_rows
        damping = max(damping * 0.2, 1e-6)
        if gain < tolerance:
            if is_fresh() or not renewed or float(r @ r) < NEAR_NOISE * r.size or is_spent():
                break
            jac, differenced_at, damping = differences(residual, parameters, values, r, threads), float(r @ r), 1e-4
        elif known is None and not is_spent():
            jac, differenced_at = differences(residual, parameters, values, r, threads), float(r @ r)
        else:
            jac = jac + np.outer(nonlinearity, taken) / max(float(taken @ taken), 1e-300)
    if derivatives.exact and not is_fresh() and not is_spent():
        jac, differenced_at = differences(residual, parameters, values, r, threads), float(r @ r)
    return Fit(parameters, values, r, jac, float(rows @ rows), row_jac, weight, differenced_at)


def _promised(normal: Array, gradient: Array, step: Array) -> float:
    """Return by how much a step lowers the cost if all answers are in proportion."""
    return -float(2.0 * gradient @ step + step @ normal @ step)


def _bounded_step(
    normal: Array,
    gradient: Array,
    damping: float,
    parameters: Sequence[FreeParameter],
    values: Mapping[FreeParameter, float],
    largest: float,
) -> Array:
    """Return a damped Newton step in coordinates; parameters that would leave their bounds stop there and the rest is solved anew.

    No logarithm changes by more than `largest`.
    """
    p = len(parameters)
    free = np.ones(p, dtype=bool)
    step = np.zeros(p)
    low = np.array([q.coordinate(q.low) - q.coordinate(values[q]) for q in parameters])
    high = np.array([q.coordinate(q.high) - q.coordinate(values[q]) for q in parameters])
    logs = np.array([q.logarithmic for q in parameters])
    low, high = np.where(logs, np.maximum(low, -largest), low), np.where(logs, np.minimum(high, largest), high)
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
