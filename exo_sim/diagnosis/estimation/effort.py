"""Samples that a subsystem predicts, counted, and how many of them one search may take: the same on every machine."""

from __future__ import annotations

from threading import Lock


class Effort:
    """How many samples were predicted so far, by any number of threads.

    Attributes:
        samples: So many.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self.samples = 0

    def add(self, samples: int) -> None:
        """Count so many more."""
        with self._lock:
            self.samples += samples


class Allowance:
    """How many samples may be predicted from now on; whoever asks whether that is used up seeks nothing more if it is.

    Args:
        effort: Where they are counted.
        most: So many.

    Attributes:
        stopped: Whether somebody has asked since it was used up.
    """

    def __init__(self, effort: Effort, most: int):
        self._effort, self._end = effort, effort.samples + most
        self.stopped = False

    @property
    def left(self) -> int:
        """How many are left of them."""
        return self._end - self._effort.samples

    def is_used_up(self) -> bool:
        """Return whether more were predicted, and remember that something was not sought for it."""
        used_up = self.left < 0
        self.stopped |= used_up
        return used_up
