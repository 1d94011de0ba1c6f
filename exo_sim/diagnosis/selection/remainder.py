"""What a model leaves of one subsystem: the conditions under which something unknown is reported for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.acceptance import CLEAN
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.left_beside import left_beside
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.declaration import declared, identification_of


@dataclass(frozen=True)
class Remainder:
    """What a model leaves.

    Attributes:
        model: The subsystem.
        fits, search: How the model was found.
        final: The model.
        named: Its candidates that are to stand as findings.
    """

    model: SubsystemModel
    fits: ModelFits
    search: SearchResult
    final: FittedModel
    named: Sequence[Candidate]

    @property
    def is_unknown(self) -> bool:
        """Whether too much is left for the names to be accepted, or nuisance parameters are strained too far."""
        if self._is_known_to_lack_a_name or self._has_bursts_without_a_name:
            return True
        if self._is_that_of_a_healthy_machine:
            return False
        if not self.named:
            return self._is_more_than_noise
        if self._is_beyond_naming:
            return True
        if self.search.weighed_together:
            return self._is_plainly_too_large or self._follows_one_signal
        return self._is_hardly_lowered or self._strains_nuisances

    @property
    def variance(self) -> float:
        """Mean square of what is left, in units of the noise; the `least_left` of the search where that is less."""
        return min(self.final.fit.sse, self.search.least_left) / self.model.size

    @property
    def _is_known_to_lack_a_name(self) -> bool:
        return bool(self.search.unnamed)

    @property
    def _has_bursts_without_a_name(self) -> bool:
        """Whether it comes in bursts that neither a name explains nor an effect of the rig whose law passes none, such as a hose."""
        if any(identification_of(c.effect).applicability.bursts for c in self.named) or not has_bursts(self.model, self.final):
            return False
        passing_none = (effect for effect in declared().values() if not effect.identification.applicability.bursts)
        return not any(self.model.nominal.is_on(effect) for effect in passing_none)

    @property
    def _is_that_of_a_healthy_machine(self) -> bool:
        """Whether it is noise, within the discrepancy bound, or no more than a healthy machine leaves beside what its laws get wrong."""
        within_bound = self.variance < CLEAN or math.sqrt(self.variance) < self.model.discrepancy_bound
        return within_bound or self._is_within_healthy_discrepancy

    @property
    def _is_within_healthy_discrepancy(self) -> bool:
        bound = self.model.discrepancy_bound
        shown = self.model.healthy_discrepancy(self.model.apply(self.final.fit.values, self.final.fixed))
        row = max(self.fits.correlation_time(self.final.fit.residual), 1.0) * max(bound, 1.0) ** 2
        return left_beside(self.final.fit, shown, row) < bound

    @property
    def _is_more_than_noise(self) -> bool:
        """Whether it is correlated from row to row, or so large that it need not be."""
        correlated = self.fits.correlation_time(self.final.fit.residual) > verdicts.UNKNOWN_CORRELATION
        return self.variance > verdicts.UNKNOWN_VARIANCE and (correlated or self.variance > verdicts.UNKNOWN_WHITE)

    @property
    def _is_beyond_naming(self) -> bool:
        """Whether it is so large that names of effects do not explain it: the subsystem is another one."""
        left = math.sqrt(self.final.fit.sse / self.model.size)
        return left > self.model.hopeless_ratio * self.model.discrepancy_bound

    @property
    def _is_plainly_too_large(self) -> bool:
        return math.sqrt(self.variance) > verdicts.PLAINLY_MORE * self.model.discrepancy_bound

    @property
    def _follows_one_signal(self) -> bool:
        """Whether one signal predicts so large a share of it that it is no mere roughness of the model."""
        left = self.model.discrepancies(self.model.apply(self.final.fit.values, self.final.fixed))
        return max((one.pattern for one in left), default=0.0) > verdicts.PATTERN

    @property
    def _is_hardly_lowered(self) -> bool:
        """Whether the names explain too little of what there was; half of it will do where what is left follows no signal."""
        start, end, n = self.search.baseline.fit, self.final.fit, self.model.size
        explained = (start.sse - end.sse) / max(start.sse - n, 1e-9)
        return explained < verdicts.EXPLAINED and (explained < verdicts.HALFWAY or self._follows_one_signal)

    @property
    def _strains_nuisances(self) -> bool:
        """Whether a nuisance parameter lies further off than it may: it stands in for something. The zero of a force may lie anywhere."""
        end = self.final.fit
        priors = [(q, q.prior) for q in end.parameters if q.prior is not None and q.effect != FORCE_OFFSET]
        strained = any(abs(end.values[q] - mean) > verdicts.STRAINED * spread for q, (mean, spread) in priors)
        return strained and self.variance > verdicts.UNKNOWN_VARIANCE


def has_bursts(model: SubsystemModel, fitted: FittedModel) -> bool:
    """Return whether what a fitted model leaves comes in bursts too fast for the rows of the fit."""
    return model.has_bursts(model.apply(fitted.fit.values, fitted.fixed))
