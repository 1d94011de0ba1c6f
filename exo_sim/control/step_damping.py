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
        every: It grows after so many of these,
        grows: by this factor,
        falls: and falls by this one after a rehearsal that
        kept: kept so much of its promise,
        bounds: between these.
    """

    value: float = 0.3
    promised: float | None = None
    failed: int = 0
    every: int = 1
    grows: float = 2.0
    falls: float = 0.3
    kept: float = 0.5
    bounds: tuple[float, float] = (0.001, 1000.0)

    def metric(self, size: NDArray[np.float64], effect: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what to add to the diagonal of the normal matrix, shape (m,).

        Args:
            size: Sum of squares over the phases of the torque that a unit of each number is [N^2 m^2], shape (m,).
            effect: Diagonal of the normal matrix, shape (m,).
        """
        return self.value * ((1.0 - _BY_EFFECT) * size + _BY_EFFECT * effect)

    def bettered(self, before: float, cost: float) -> StepDamping:
        """Return the damping after a rehearsal that cost less than the best before it."""
        kept = self.promised is not None and np.isfinite(before) and before - cost > self.kept * (before - self.promised)
        return replace(self, value=max(self.bounds[0], self.falls * self.value) if kept else self.value, failed=0)

    def missed(self) -> StepDamping:
        """Return the damping after a rehearsal that bettered nothing."""
        failed = self.failed + 1
        value = min(self.bounds[1], self.grows * self.value) if failed % self.every == 0 else self.value
        return replace(self, value=value, failed=failed)


#: Where two maps have their turns, neither worked out along the walk: both fail before a step is shortened.
BY_TWO_MAPS = StepDamping(every=2, grows=3.0, falls=0.5, kept=0.25, bounds=(0.01, 100.0))
