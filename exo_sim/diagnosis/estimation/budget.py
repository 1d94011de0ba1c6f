"""The time that a diagnosis may take, and the part of it that each of its stages may."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

#: Asked now and then by what takes long: whether it is to end with the best that it has.
IsSpent = Callable[[], bool]


def never() -> bool:
    """Return that there is time, always."""
    return False


class Budget:
    """Wall-clock time, counted from when this is made; whoever asks whether it is spent leaves something out if it is.

    Stages follow each other: each may go on until its share of the whole is over, so that what comes later has time as well. Within a
    budget that ends anything early, the answer depends on how fast the machine is.

    Args:
        seconds: How long; without end when absent.

    Attributes:
        stopped: Whether something was left out.
    """

    def __init__(self, seconds: float = math.inf):
        self._seconds, self._begun = seconds, time.monotonic()
        self._end = self._begun + seconds
        self.stopped = False

    def allow_until(self, share: float) -> None:
        """Let what is asked from now on go on until this share of the whole is over."""
        self._end = self._begun + share * self._seconds

    @property
    def used(self) -> float:
        """Seconds that went by."""
        return time.monotonic() - self._begun

    @property
    def left(self) -> float:
        """Seconds that are left of the whole; infinite where there is no end."""
        return self._seconds - self.used

    def is_spent(self) -> bool:
        """Return whether it is spent, and remember that something was left out for it."""
        spent = time.monotonic() > self._end
        self.stopped |= spent
        return spent
