"""Moments of a run, and the time between them without that of compiling, which only a first run takes."""

from __future__ import annotations

import time
from dataclasses import dataclass

from exo_sim.physics.compile_time import compiled_seconds


@dataclass(frozen=True)
class Moment:
    """A moment.

    Attributes:
        at: As `time.perf_counter` says [s].
        compiled: What compiling had taken by then [s].
    """

    at: float
    compiled: float

    @classmethod
    def now(cls) -> Moment:
        """Return this one."""
        return cls(time.perf_counter(), compiled_seconds())

    def until(self, later: Moment) -> float:
        """Return the time to a later one without compiling [s]."""
        return later.at - self.at - (later.compiled - self.compiled)
