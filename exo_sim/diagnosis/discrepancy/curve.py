"""A missing force or flow as a smooth curve of one measured variable, with its predictive power and a band."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.recordings import FEWEST_A_KNOT

Array = NDArray[np.float64]

#: Knots of the fitted curve.
KNOTS = 13
#: Folds of the cross-validation, made of whole blocks of time.
FOLDS = 6


@dataclass(frozen=True)
class Curve:
    """What is missing as a function of one variable.

    Attributes:
        variable: Its name.
        at, values, band: Knots, missing amount there, and twice its standard error, shape (m,) each.
        explains: Share of the variance that it predicts in cross-validation.
        resists: Whether the values are a friction, against the motion.
    """

    variable: str
    at: Array
    values: Array
    band: Array
    explains: float
    resists: bool = False

    def __call__(self, variable: Array) -> Array:
        """Return the missing amount at these values of the variable, shape (n,)."""
        return hats(variable, self.at) @ self.values


def hats(variable: Array, at: Array) -> Array:
    """Return the weights of piecewise-linear interpolation between knots, shape (n, m)."""
    place = np.clip(np.searchsorted(at, variable) - 1, 0, len(at) - 2)
    share = np.clip((variable - at[place]) / (at[place + 1] - at[place]), 0.0, 1.0)
    weights = np.zeros((len(variable), len(at)))
    rows = np.arange(len(variable))
    weights[rows, place] = 1.0 - share
    weights[rows, place + 1] = share
    return weights


def fit_curve(name: str, variable: Array, missing: Array, blocks: NDArray[np.int64]) -> Curve | None:
    """Fit what is missing as a curve of one variable, second differences penalised; None where the variable hardly varies.

    Args:
        name: Of the variable.
        variable, missing: Rows, shape (n,).
        blocks: Block of time of each row.
    """
    if len(variable) < FEWEST_A_KNOT * KNOTS:
        return None
    spread = np.percentile(variable, [1.0, 99.0])
    if not spread[1] - spread[0] > 1e-12:
        return None
    even = np.linspace(spread[0], spread[1], KNOTS)
    design = hats(variable, even)
    smooth = np.diff(np.eye(KNOTS), 2, axis=0) * np.sqrt(0.02 * len(variable) / KNOTS)
    fold = (blocks * 7919) % FOLDS

    def solve(rows: NDArray[np.bool_]) -> Array:
        return np.linalg.lstsq(
            np.vstack([design[rows], smooth]), np.append(missing[rows], np.zeros(len(smooth))), rcond=None
        )[0]

    predicted = np.zeros(len(missing))
    for k in range(FOLDS):
        test = fold == k
        if test.any() and (~test).sum() > KNOTS:
            predicted[test] = design[test] @ solve(~test)
    total = float(np.sum((missing - missing.mean()) ** 2))
    explains = 1.0 - float(np.sum((missing - predicted) ** 2)) / total if total > 0.0 else 0.0
    values = solve(np.ones(len(missing), dtype=bool))
    left = missing - design @ values
    weight = np.maximum(design.sum(0), 1.0)
    band = 2.0 * np.sqrt(np.maximum((design**2).T @ left**2, 0.0)) / weight
    return Curve(name, even, values, band, explains)


def fit_curves(variables: Mapping[str, Array], missing: Array, blocks: NDArray[np.int64]) -> tuple[Curve, ...]:
    """Return a curve against every variable, the one that predicts most first."""
    found = []
    for name, values in variables.items():
        if len(values) != len(missing):
            continue  # not every recording has it
        good = np.isfinite(missing) & np.isfinite(values)
        found.append(fit_curve(name, values[good], missing[good], blocks[good]))
    return tuple(sorted((curve for curve in found if curve is not None), key=lambda curve: -curve.explains))
