"""The time that a diagnosis may take."""

from __future__ import annotations

import math
import time


class Budget:
    """Wall-clock time, counted from when this is made; whoever asks whether it is spent leaves something out if it is.

    Within a budget that ends a search early, the answer depends on how fast the machine is.

    Args:
        seconds: How long; without end when absent.

    Attributes:
        stopped: Whether something was left out.
    """

    def __init__(self, seconds: float = math.inf):
        self._end = time.monotonic() + seconds
        self.stopped = False

    def is_spent(self) -> bool:
        """Return whether it is spent, and remember that something was left out for it."""
        spent = time.monotonic() > self._end
        self.stopped |= spent
        return spent
