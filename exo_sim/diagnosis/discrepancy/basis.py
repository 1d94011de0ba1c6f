"""The discrepancy of a subsystem as a sum of smooth functions with unknown amplitudes: what every model of a real machine gets wrong.

An additive Gaussian process (Kennedy and O'Hagan 2001) in the form of its basis: each kind of columns is a smooth function of some of
the subsystem's inputs, its weights normal with one amplitude. Columns have mean zero over the rows that they describe, so that they say
how something varies and not its level.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.curve import hats

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DiscrepancyBasis:
    """Columns of a discrepancy.

    Attributes:
        names: What each kind depends on, k of them.
        columns: Response of the whitened residual to each weight, shape (n, d).
        kinds: Kind of each column, shape (d,).
        healthy: Scale of the half-normal prior of each kind's amplitude, what a healthy machine shows, shape (k,).
    """

    names: tuple[str, ...]
    columns: Array
    kinds: NDArray[np.int64]
    healthy: Array

    def deviation(self) -> Array:
        """Return how far a healthy machine is off in each row, one standard deviation at those scales, shape (n,)."""
        return np.sqrt(self.columns**2 @ self.healthy[self.kinds] ** 2)


def joined(kinds: Sequence[tuple[str, Array, float]], rows: int) -> DiscrepancyBasis:
    """Return a basis of several kinds: name, columns of shape (rows, d_k), and prior scale of the amplitude."""
    kept = [one for one in kinds if one[1].shape[1]]
    columns = np.hstack([columns for _, columns, _ in kept]) if kept else np.zeros((rows, 0))
    index = np.array([k for k, (_, columns, _) in enumerate(kept) for _ in range(columns.shape[1])], dtype=np.int64)
    return DiscrepancyBasis(tuple(name for name, _, _ in kept), columns, index, np.array([scale for _, _, scale in kept]))


def smooth_functions(variable: Array, knots: int) -> Array:
    """Return piecewise-linear functions of a variable between its outer half percents, less their means, shape (n, knots).

    Without columns where the variable does not vary.
    """
    low, high = np.percentile(variable, [0.5, 99.5]) if variable.size else (0.0, 0.0)
    if not high > low:
        return np.zeros((variable.size, 0))
    found = hats(variable, np.linspace(low, high, knots))
    return found - found.mean(axis=0)
