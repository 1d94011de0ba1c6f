"""How far a rehearsal may go from the best one so far: Levenberg's and Marquardt's damping of a least-squares step.

Beside the loads that a map promises, a change of the torques counts by itself, and the more so, the less the last ones kept of what was
promised (Levenberg 1944, Quarterly of Applied Mathematics 2:164-168; Marquardt 1963, SIAM Journal 11:431-441). A damped step goes first
where torques do much, and leaves for later what large torques do little to; a step that is only shortened asks for both, and puts feet
on the ground elsewhere long before the loads are met.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

#: Newton metres of change count as so many of load, at the start, at the least and at the most.
_FIRST, _LEAST, _MOST = 0.3, 0.01, 100.0
#: It grows after every second change that failed, each of two maps having had its turn, and falls after one that kept this share of its
#: promise.
_GROWS, _FALLS, _KEPT = 3.0, 0.5, 0.25
#: Share of Marquardt's measure, what a change does to loads and effort, in what it counts; the rest is Levenberg's, its size in newton
#: metres. Of 0, 0.1, 0.3 and 1 a tenth left the least cost in seven walks (level, causal, slopes, fast, stairs).
_BY_EFFECT = 0.1


@dataclass(frozen=True)
class StepDamping:
    """What a change of the torques counts by itself.

    Attributes:
        value: Newton metres of load for one of change.
        promised: The cost that the next rehearsal was promised to have; None before there is any.
        failed: How many rehearsals failed since the last that bettered the best.
    """

    value: float = _FIRST
    promised: float | None = None
    failed: int = 0

    def metric(self, size: NDArray[np.float64], effect: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what to add to the diagonal of the normal matrix, shape (m,).

        Args:
            size: Sum of squares over the phases of the torque that a unit of each number is [N^2 m^2], shape (m,).
            effect: Diagonal of the normal matrix, shape (m,).
        """
        return self.value * ((1.0 - _BY_EFFECT) * size + _BY_EFFECT * effect)

    def bettered(self, before: float, cost: float) -> StepDamping:
        """Return the damping after a rehearsal that cost less than the best before it."""
        kept = self.promised is not None and np.isfinite(before) and before - cost > _KEPT * (before - self.promised)
        return replace(self, value=max(_LEAST, _FALLS * self.value) if kept else self.value, failed=0)

    def missed(self) -> StepDamping:
        """Return the damping after a rehearsal that bettered nothing."""
        failed = self.failed + 1
        return replace(self, value=min(_MOST, _GROWS * self.value) if failed % 2 == 0 else self.value, failed=failed)
