"""Means over a stride of what was seen at each phase of it, once the stride is over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.machine_dynamics import PHASES


class StrideMeans:
    """Values gathered at PHASES even phases.

    Args:
        width: How many values are taken in at a time.
    """

    def __init__(self, width: int) -> None:
        self._sum, self._count = np.zeros((PHASES, width)), np.zeros(PHASES)
        self.forget()

    def forget(self) -> None:
        """Begin with the stride of the next values."""
        self._sum[:], self._count[:] = 0.0, 0.0
        self._stride: float | None = None

    def take(self, phase: float, values: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Take in values at a phase, whole strides counted on.

        Returns:
            Where a stride is over and has no gaps, its means, shape (PHASES, width).
        """
        stride, over = float(np.floor(phase)), None
        if self._stride is None:
            self._stride = stride
        if stride > self._stride:
            if stride == self._stride + 1.0 and self._count.min() > 0:
                over = self._sum / self._count[:, None]
            self._stride = stride
            self._sum[:], self._count[:] = 0.0, 0.0
        box = int((phase % 1.0) * PHASES + 0.5) % PHASES
        self._sum[box] += values
        self._count[box] += 1.0
        return over
