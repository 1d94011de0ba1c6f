"""What the final model of a subsystem still misses: its share of what there was to explain, and its size in the unit of the signal."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exo_sim.diagnosis.policy import recordings
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel


@dataclass(frozen=True)
class FinalResidual:
    """What is left.

    Attributes:
        share: Of the squared error above the noise that there was to explain, 0 to 1.
        error: Root mean square of what the worst balance misses, in `unit`.
        noise: What sensors alone would leave there.
        unit: Of both.
    """

    share: float
    error: float
    noise: float
    unit: str

    @property
    def times_noise(self) -> float:
        """The error in units of the noise."""
        return self.error / self.noise if self.noise > 0.0 else 0.0


def final_residual(result: SubsystemResult[SubsystemModel]) -> FinalResidual:
    """Return what a result's final model misses on the time that it was fitted to."""
    n = result.model.size
    left = max(result.final.fit.sse - recordings.EXPLAINED_VARIANCE * n, 0.0) / max(result.search.baseline.fit.sse - n, 1e-9)
    worst = FinalResidual(min(left, 1.0), 0.0, 0.0, result.model.unit)
    squares: dict[str, tuple[float, int, float, str]] = {}
    for trace in result.model.traces(result.final_plant):
        good = trace.error[np.isfinite(trace.error)]
        total, count, noise, _ = squares.get(trace.where, (0.0, 0, 0.0, trace.unit))
        squares[trace.where] = (total + float(good @ good), count + good.size, max(noise, trace.noise), trace.unit)
    for total, count, noise, unit in squares.values():
        one = FinalResidual(worst.share, math.sqrt(total / max(count, 1)), noise, unit)
        worst = max(worst, one, key=lambda each: each.times_noise)
    return worst
