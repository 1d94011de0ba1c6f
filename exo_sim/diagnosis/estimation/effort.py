"""Samples that a subsystem predicts, counted: what a search costs is the same on every machine."""

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
