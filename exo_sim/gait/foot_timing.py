"""Feet of a walk that leave the ground sooner or later in their stride."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait.footpaths import Paths
from exo_sim.gait.motion import SAMPLES, Motion, phases

Array = NDArray[np.float64]


def leaving_later(it: Paths, like: Motion, later: float) -> tuple[Paths, Motion]:
    """Return a walk whose feet leave the ground later in their stride, and strike when they did.

    In between a foot does what it did, later by a share of that which is one where it leaves and nil, without an edge, where it strikes.

    Args:
        it: One stride; the pelvis stays as it is.
        like: Says how far the stride goes, and shares of the load, centres of pressure and contacts, which go with the feet.
        later: By how much [strides]; sooner where it is below nil.

    Returns:
        The paths, and the motion with what goes with them; its coordinates are those of `like`.
    """
    if later == 0.0:
        return it, like
    right = phases()
    stance_end = np.count_nonzero(like.share[:, 1]) / SAMPLES
    off = later * (np.sin(np.pi * np.stack([right + 0.5, right], axis=1)) / np.sin(np.pi * (stance_end + later))) ** 2
    at = (right[:, None] - off) % 1.0
    steady = like.advance * right[:, None]
    ahead = _at(at, it.ahead - steady) + steady - like.advance * off
    moved = replace(it, ahead=ahead, up=_at(at, it.up), pitch=_at(at, it.pitch), roll=_at(at, it.roll))
    share = _between(at, like.share)
    nearest = np.rint(at * SAMPLES).astype(int) % SAMPLES
    contact = np.stack([like.contact[nearest[:, i // 2], i] for i in range(4)], axis=1)
    return moved, replace(
        like, share=share / share.sum(axis=1, keepdims=True), pressure_centre=_between(at, like.pressure_centre), contact=contact
    )


def _at(at: Array, values: Array) -> Array:
    """Return smooth periodic values at phases, a column each, shape (n, 2)."""
    from scipy.interpolate import CubicSpline  # not for walks as they were recorded

    grid = np.arange(SAMPLES + 1) / SAMPLES
    splines = (CubicSpline(grid, np.append(column, column[0]), bc_type="periodic") for column in values.T)
    return np.stack([spline(phase) for spline, phase in zip(splines, at.T)], axis=1)


def _between(at: Array, values: Array) -> Array:
    """Return periodic values that may have edges at phases, a column each, shape (n, 2)."""
    return np.stack([np.interp(phase, phases(), column, period=1.0) for phase, column in zip(at.T, values.T)], axis=1)
