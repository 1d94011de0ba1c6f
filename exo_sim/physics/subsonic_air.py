"""The flow factor of air below choking as a polynomial: a power would be a fifth of what a prediction with hoses takes.

Gamma (the paper's equation 26) squared and divided by 1 - ratio is smooth from the critical ratio to 1, and the power's singularity at
0 is far: interpolated at Chebyshev's points (Trefethen, Approximation Theory and Approximation Practice, chapter 8) its error falls by
6.3 a degree. Degree 14 is right to 2e-15 of gamma; by the power, whose two terms cancel near equal pressures, it is right to 3e-13.
"""

from __future__ import annotations

import math

from exo_sim.physics.compiled import inlined_kernel

#: Ratio of specific heats of air, and the pressure ratio at which it chokes.
K = 1.4
CHOKES = (2.0 / (K + 1.0)) ** (K / (K - 1.0))

_MIDDLE, _TO_S = 0.5 * (1.0 + CHOKES), 2.0 / (1.0 - CHOKES)

#: Of gamma^2 / (1 - ratio), by powers of s = (ratio - _MIDDLE) * _TO_S, s from -1 to 1.
_C = (
    1.0678958010461, 0.35993679291919717, 0.0012319920095207769, -0.0005990671364160195, 0.0001282868710133981,
    -2.7279730664778526e-05, 6.0178314029712965e-06, -1.3772507871320406e-06, 3.253378380918547e-07, -7.902869784604047e-08,
    1.953666052637952e-08, -4.760078963222368e-09, 1.2582252869227291e-09, -4.3553758655116824e-10, 1.0365207951205472e-10,
)  # fmt: skip


@inlined_kernel
def flow_factor(ratio: float) -> float:
    """Return gamma of equation 26 for air and a throat pressure ratio from `CHOKES` to 1."""
    s = (ratio - _MIDDLE) * _TO_S
    s2 = s * s
    s4 = s2 * s2
    # in pairs (Estrin): Horner's chain of 14 would take as long as the power
    low = (_C[0] + _C[1] * s) + (_C[2] + _C[3] * s) * s2 + ((_C[4] + _C[5] * s) + (_C[6] + _C[7] * s) * s2) * s4
    high = (_C[8] + _C[9] * s) + (_C[10] + _C[11] * s) * s2 + ((_C[12] + _C[13] * s) + _C[14] * s2) * s4
    return math.sqrt((1.0 - ratio) * (low + high * (s4 * s4)))
