"""Bursts of a pressure error that are too fast for the rows of a fit: something rings, and no slow effect explains it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.cylinder_run import CylinderRun
from exo_sim.diagnosis.policy.healthy import BURST_LENGTH, LIVELY
from exo_sim.diagnosis.subsystems.gas.rows import Rows, floor

Array = NDArray[np.float64]


def burst_ratio(fast: Array, noise: float) -> float:
    """Return the level of the lively stretches over the median level, or over the sensor's noise where that is larger.

    Args:
        fast: Errors less the mean of their row, shape (n,).
        noise: Standard deviation of the sensor's white noise.
    """
    count = len(fast) // BURST_LENGTH
    if count < 2:
        return 0.0
    level = np.sqrt(np.mean(fast[: count * BURST_LENGTH].reshape(count, BURST_LENGTH) ** 2, axis=1))
    return float(np.percentile(level, LIVELY) / max(noise, float(np.median(level)), 1e-12))


def fast_errors(run: CylinderRun, errors: Array, rows: Sequence[Rows]) -> list[tuple[Array, float]]:
    """Return what is too fast for the rows in the errors of each pressure [Pa], shape (n,), and what noise and a prediction leave [Pa].

    A pressure whose rows are single samples has none.

    Args:
        run: The run.
        errors: Measured less predicted pressures, shape (n, 2) [Pa].
        rows: Of each pressure.
    """
    found = []
    for side, (noise, measured) in enumerate(zip(run.noise, run.pressure, strict=True)):
        if measured is not None and rows[side].count.size and float(np.median(rows[side].count)) > 2.0:
            found.append((rows[side].beyond(errors[:, side]), max(noise, floor(measured[np.isfinite(measured)]))))
    return found
