"""What a change of the torques does to the loads: a linear map, mended by what each rehearsal showed.

Contact is not linear, so that a map that was worked out for feet that stand as planned, or as in one rehearsal, promises what the next one
does not keep. What it did tells the map along the change that was made, and nothing else is changed (Broyden 1965, "A class of methods for
solving nonlinear simultaneous equations", Mathematics of Computation 19:577-593). A map that was only thought of is updated by half: the
same torques cost a percent more or less from rehearsal to rehearsal, and a whole update makes a map of that. One that was worked out along
the walk is right for small changes, and what a failed one says of the next foot that touches is taken whole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

#: Share of an update that is taken. Of 0.3, 0.5 and 0.7 a half left the least cost, or nearly, in 14 walks (levels, slopes, stairs, speeds,
#: three ankles, two machines); 0.7 lost the walk from rest to rest, which a half does not.
BELIEVED = 0.5


@dataclass(frozen=True)
class LearntMap:
    """How loads answer to a change of some numbers.

    Attributes:
        effect: Loads for each number, shape (loads, m).
        effort: What a number costs by itself, in units of loads, shape (m,).
    """

    effect: NDArray[np.float64]
    effort: NDArray[np.float64]

    @cached_property
    def gain(self) -> NDArray[np.float64]:
        """Inverse of the normal matrix, shape (m, m)."""
        return np.asarray(np.linalg.inv(self.effect.T @ self.effect + np.diag(self.effort**2)))

    def correction(self, load: NDArray[np.float64], at: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what to take off the numbers, shape (m,), for the loads that they gave, where they were `at`."""
        return np.asarray(self.gain @ (self.effect.T @ load + self.effort**2 * at))

    def damped(
        self, load: NDArray[np.float64], at: NDArray[np.float64], metric: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    ) -> NDArray[np.float64]:
        """Return `correction` where a change counts by itself, too.

        Args:
            load: The loads that the numbers gave, shape (loads,).
            at: Where the numbers were, shape (m,).
            metric: What to add to a diagonal of the normal matrix, shape (m,), for it.
        """
        normal = self.effect.T @ self.effect + np.diag(self.effort**2)
        normal[np.diag_indices_from(normal)] += metric(np.diag(normal).copy())
        return np.asarray(np.linalg.solve(normal, self.effect.T @ load + self.effort**2 * at))

    def promised(self, load: NDArray[np.float64], at: NDArray[np.float64], change: NDArray[np.float64]) -> float:
        """Return the cost that a change of the numbers (m,) would have by this map, from loads (loads,) where they were `at`."""
        left, asked = load + self.effect @ change, self.effort * (at + change)
        return float(left @ left + asked @ asked)

    def updated(self, change: NDArray[np.float64], answer: NDArray[np.float64], believed: float = BELIEVED) -> LearntMap:
        """Return the map that knows what loads answered, shape (loads,), to a change of the numbers, shape (m,).

        Directions are told apart by what they do to loads and effort.
        """
        expected = self.effect @ change
        felt = self.effect.T @ expected + self.effort**2 * change
        size = float(change @ felt)
        if size <= 0.0:
            return self
        return replace(self, effect=self.effect + np.outer(believed * (answer - expected), felt / size))
