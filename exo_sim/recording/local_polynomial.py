"""Values and derivatives of a signal by polynomials over a few samples (Savitzky and Golay 1964).

The same numbers as of `scipy.signal`, which takes a third of a second to import: a tenth of a short command.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq
from scipy.ndimage import convolve1d

Array = NDArray[np.float64]


def weights(points: int, order: int, at: int, derivative: int = 0, step: float = 1.0) -> Array:
    """Return what a polynomial's derivative takes of each of its samples, shape (points,).

    Args:
        points: How many samples, more than `order`.
        order: Of the polynomial.
        at: Index of the sample at which it is evaluated.
        derivative: Of which order, at most `order`.
        step: Sample interval.
    """
    return _solved(np.arange(-at, points - at, dtype=float), order, derivative, step)


def filtered(values: Array, points: int, order: int, derivative: int = 0, step: float = 1.0) -> Array:
    """Return the derivative at every sample, shape (n,), by the polynomial around it; near an end by the first or last one.

    Args:
        values: Evenly sampled, shape (n,).
        points: An odd number of samples, at most n and more than `order`.
        order, derivative, step: As of `weights`.
    """
    half = points // 2
    behind = np.arange(half, half - points, -1, dtype=float)  # a convolution takes the samples the other way round
    found: Array = convolve1d(values, _solved(behind, order, derivative, step), mode="constant")
    found[:half] = _of_one(values[:points], np.arange(half, dtype=float), order, derivative, step)
    found[-half:] = _of_one(values[-points:], np.arange(points - half, points, dtype=float), order, derivative, step)
    return found


def _solved(places: Array, order: int, derivative: int, step: float) -> Array:
    powers = places ** np.arange(order + 1, dtype=float)[:, None]
    wanted = np.zeros(order + 1)
    wanted[derivative] = math.factorial(derivative) / step**derivative
    return np.asarray(lstsq(powers, wanted, cond=_smallest(powers))[0])


def _of_one(values: Array, at: Array, order: int, derivative: int, step: float) -> Array:
    """Return the derivative at some places, counted in samples, of the one polynomial through all values."""
    powers = np.arange(len(values), dtype=float)[:, None] ** np.arange(order, -1, -1, dtype=float)
    scale = np.sqrt(np.sum(powers * powers, axis=0))
    powers /= scale
    coefficients = lstsq(powers, values, cond=_smallest(powers))[0] / scale
    return np.asarray(np.polyval(np.polyder(coefficients, derivative), at) / step**derivative)


def _smallest(powers: Array) -> float:
    """Return the share of the largest singular value below which one counts as nil."""
    return float(np.finfo(float).eps) * max(powers.shape)
