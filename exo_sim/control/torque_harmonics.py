"""Torques of joints along a cycle as harmonics: for each joint a constant, then cosine and sine of each harmonic."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def basis(count: int, harmonics: int) -> NDArray[np.float64]:
    """Return constant, cosines and sines of the harmonics at evenly spaced phases, shape (count, 2 harmonics + 1)."""
    return basis_at(np.arange(count) / count, harmonics)


def basis_at(phase: NDArray[np.float64], harmonics: int) -> NDArray[np.float64]:
    """Return constant, cosines and sines of the harmonics at phases [cycles], shape (n, 2 harmonics + 1)."""
    turned = 2.0 * np.pi * phase[:, None] * np.arange(1, harmonics + 1)
    waves = np.stack([np.cos(turned), np.sin(turned)], axis=2).reshape(len(phase), -1)
    return np.concatenate([np.ones((len(phase), 1)), waves], axis=1)


def fitted(table: NDArray[np.float64], harmonics: int) -> NDArray[np.float64]:
    """Return the coefficients, one joint after the other, that come closest to torques at even phases [N m], shape (n, joints)."""
    found = np.linalg.lstsq(basis(len(table), harmonics), table, rcond=None)[0]
    return np.asarray(found.T.reshape(-1), dtype=np.float64)


def delayed(coefficients: NDArray[np.float64], joints: int, cycles: float) -> NDArray[np.float64]:
    """Return the coefficients of the same torques of so many joints so much later [cycles]."""
    waves = coefficients.reshape(joints, -1).copy()
    angle = 2.0 * np.pi * np.arange(1, waves.shape[1] // 2 + 1) * cycles
    cosine, sine = waves[:, 1::2].copy(), waves[:, 2::2].copy()
    waves[:, 1::2] = np.cos(angle) * cosine - np.sin(angle) * sine
    waves[:, 2::2] = np.sin(angle) * cosine + np.cos(angle) * sine
    return waves.reshape(-1)
