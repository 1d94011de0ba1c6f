"""Coefficients of the second-order Runge-Kutta-Chebyshev method (Sommeijer, Shampine and Verwer 1997).

Explicit, so mass and energy are kept to rounding; its stable step grows with the square of the number of stages, so a small
volume behind an open path costs a few more stages instead of many more steps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.compiled import inlined_kernel

#: The most stages in one step; beyond that `step_length.py` divides it.
MOST_STAGES = 20

#: How strongly modes that are faster than a step are damped. With the authors' 2/13 they fade by a twentieth a step, and a small volume
#: between two open paths rings for many steps: its flow, which goes with the root of the pressure, is then wrong on average. With 3
#: they fade by half, for a sixth more stages.
_DAMPING = 3.0


def _chebyshev(n: int, w: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return T_j, T_j' and T_j'' at w for j = 0..n."""
    t, d, dd = np.zeros((3, n + 1))
    t[0], t[1], d[1] = 1.0, w, 1.0
    for j in range(2, n + 1):
        t[j] = 2 * w * t[j - 1] - t[j - 2]
        d[j] = 2 * w * d[j - 1] - d[j - 2] + 2 * t[j - 1]
        dd[j] = 2 * w * dd[j - 1] - dd[j - 2] + 4 * d[j - 1]
    return t, d, dd


def coefficients(stages: int) -> NDArray[np.float64]:
    """Return one row a stage: mu, nu, mu~, gamma~ and the time c of the stage before, shape (stages + 1, 5)."""
    w0 = 1.0 + _DAMPING / stages**2
    t, d, dd = _chebyshev(stages, w0)
    w1 = d[stages] / dd[stages]
    b = np.empty(stages + 1)
    b[2:] = dd[2:] / d[2:] ** 2
    b[:2] = b[2]
    c = np.zeros(stages + 1)
    c[2:] = w1 * dd[2:] / d[2:]
    c[1] = c[2] / (4 * w0)
    rows = np.zeros((stages + 1, 5))
    rows[1, 2] = b[1] * w1
    for j in range(2, stages + 1):
        rows[j, 0] = 2 * b[j] * w0 / b[j - 1]
        rows[j, 1] = -b[j] / b[j - 2]
        rows[j, 2] = 2 * b[j] * w1 / b[j - 1]
        rows[j, 3] = -(1.0 - b[j - 1] * t[j - 1]) * rows[j, 2]
        rows[j, 4] = c[j - 1]
    return rows


def stable_reach(stages: int) -> float:
    """Return the largest h * lambda that this many stages keep stable."""
    w0 = 1.0 + _DAMPING / stages**2
    _, d, dd = _chebyshev(stages, w0)
    return float((w0 + 1.0) * dd[stages] / d[stages])


#: COEFFICIENTS[s, j] are the five numbers of stage j of the s-stage method.
COEFFICIENTS = np.zeros((MOST_STAGES + 1, MOST_STAGES + 1, 5))
#: REACH[s] is the stable h * lambda of the s-stage method.
REACH = np.zeros(MOST_STAGES + 1)
for _stages in range(2, MOST_STAGES + 1):
    COEFFICIENTS[_stages, : _stages + 1] = coefficients(_stages)
    REACH[_stages] = stable_reach(_stages)


@inlined_kernel
def enough_stages(reach: float) -> int:
    """Return how many stages are stable up to h * lambda = `reach`; never more than there are."""
    stages = 2
    while stages < MOST_STAGES and REACH[stages] < reach:
        stages += 1
    return stages
