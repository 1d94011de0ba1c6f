"""How far a prediction strays in one run over a recording, and how far it may: windows that begin anew hide what adds up slowly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.uncertainty import covariance
from exo_sim.diagnosis.policy.validation import HEALTHY_KNOWN
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel

#: A response is taken over so small a part of a number's standard error: numbers that stand in for each other have large ones.
STEPS = 10.0


@dataclass(frozen=True)
class Straying:
    """The error of a subsystem on the test time, predicted in one run, root mean square in units of the noise.

    Attributes:
        error: With everything that was found.
        healthy: What the structural error of a healthy machine and the slow losses that it has leave at most.
        spread: Standard deviation of that, with noise and numbers that are known only so well.
    """

    error: float
    healthy: float
    spread: float

    @property
    def explained(self) -> float:
        """The error that one machine in six without anything else exceeds."""
        return self.healthy + self.spread

    @property
    def beyond(self) -> float:
        """By how many standard deviations the error exceeds what a healthy machine leaves; 0 where it does not."""
        return max(self.error - self.healthy, 0.0) / self.spread

    @property
    def log10_odds(self) -> float:
        """That something else acts, by the likelihood of so large an error without it."""
        return 0.5 * self.beyond**2 / math.log(10.0)


def straying(one: SubsystemResult[SubsystemModel], split: Split) -> Straying | None:
    """Return how far the final model of a subsystem strays over the test time in one run; None where it predicts none that is finite.

    With J the responses of the rows to the fitted numbers and C the covariance of those, J C J' is the covariance that a prediction has
    because they are known only so well. Each healthy imperfection adds what it would do on its own.

    Args:
        one: Its result.
        split: Its test time counts.
    """
    run = None if one.is_empty else one.model.in_one_run(split)
    if run is None or run.size == 0:
        return None
    plant, fit = one.final_plant, one.final.fit
    residual = run.residual_of(plant)
    if not np.isfinite(residual).all():
        return None
    known = covariance(fit, one.fits.correlation_time(fit.residual))
    columns = []
    for j, parameter in enumerate(fit.parameters):
        value = fit.values[parameter]
        step = math.sqrt(max(known[j, j], 0.0)) / STEPS * parameter.slope(value)
        step = step if value + step <= parameter.high else -step
        moved = one.model.apply({**fit.values, parameter: value + step}, one.final.fixed)
        by = parameter.coordinate(value + step) - parameter.coordinate(value)
        columns.append((run.residual_of(moved) - residual) / by if by else np.zeros(run.size))
    responses = np.stack(columns, axis=1) if columns else np.zeros((run.size, 0))
    known_so_well = float(np.einsum("ij,jk,ik->", responses, known, responses)) / run.size
    losses = sum(rms(run.residual_of(other) - residual) ** 2 for other in one.model.healthy_variants(plant))
    healthy = math.hypot(run.discrepancy_bound, math.sqrt(losses))
    return Straying(rms(residual), healthy, math.sqrt(1.0 + known_so_well + (HEALTHY_KNOWN * healthy) ** 2))
