"""The evidence of a fitted model: of what it leaves, beside the noise and the discrepancy that maximise it.

A linear family has the evidence of its subsets in closed form; of models that were fitted to the subsystem itself this is asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.discrepancy.basis import DiscrepancyBasis
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.linear_family import Linearisation
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.policy.priors import LEAST_NOISE
from exo_sim.diagnosis.selection.evidence import price_of_parameter
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.linear_evidence import LinearEvidence, Spreads
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.refitted_finalists import probability_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FittedEvidence:
    """The evidence of the fits of one subsystem.

    Attributes:
        fits: The fits.
        basis: Of the discrepancy.
        correlation_time: Of the residual, in rows.
    """

    fits: ModelFits
    basis: DiscrepancyBasis
    correlation_time: float

    def log_evidence(self, model: FittedModel, spreads: Spreads) -> float:
        """Return the logarithm of a fitted model's evidence: of what it leaves, parameters paid for, names as common as they are.

        Args:
            model: Fitted.
            spreads: Where the estimation of those of what it leaves begins, but for the noise.
        """
        common = sum(c.prior_log_odds for c in model.candidates)
        own = replace(spreads, noise=max(rms(model.fit.residual), float(LEAST_NOISE)))
        return self._of_remainder(model.fit.residual, own)[0] - 0.5 * model.fit.penalty - self._price(model) + common

    def _price(self, model: FittedModel) -> float:
        """Return the log-likelihood that a model's parameters must bring on.

        What is known of a shape beforehand need not be learnt: it costs the logarithm of how much narrower it becomes (its Occam factor;
        MacKay 1992), nothing where the data say nothing of it.
        """
        known = {q: q.prior[1] for q in model.effect_parameters if q.is_shape and q.prior is not None}
        errors = self.fits.standard_errors(model) if known else {}
        narrowed = sum(max(math.log(spread / max(errors.get(q, 0.0), 1e-12)), 0.0) for q, spread in known.items())
        usual = price_of_parameter(self.fits.model.size / self.correlation_time)
        return usual * (model.parameter_count - len(known)) + narrowed

    def probability_in(self, candidate: Candidate, final: FittedModel, spreads: Spreads) -> float:
        """Return the probability of an effect of a fitted model against the fit without it."""
        without = self.fits.fit(drop_orphans(final.without(candidate)), final)
        return probability_of(self.log_evidence(final, spreads) - self.log_evidence(without, spreads))

    def is_decisive(self, final: FittedModel, baseline: FittedModel, spreads: Spreads) -> bool:
        """Return whether the odds of all names together are decisive where nuisance parameters are fitted as they act, not linearised.

        Asked where the nuisance parameters alone leave nothing but noise: a law that the rig has may be far from its linearisation.
        Each model is held against the noise and the discrepancy that it leaves itself, as subsets are: a machine may be quieter than its
        sensors' noise is taken for.

        Args:
            final: With the names.
            baseline: The nuisance parameters alone.
            spreads: As of `log_evidence`.
        """
        price = price_of_parameter(self.fits.model.size) * (final.parameter_count - baseline.parameter_count)
        gain = self._evidence_left(final, spreads) - self._evidence_left(baseline, spreads) - price
        return gain + sum(c.prior_log_odds for c in final.candidates) > acceptance.LEAST_ODDS * math.log(10.0)

    def _evidence_left(self, model: FittedModel, spreads: Spreads) -> float:
        """Return the logarithm of the evidence of what a model leaves, its priors included."""
        found, _ = self._of_remainder(model.fit.residual, spreads)
        return found - 0.5 * model.fit.penalty

    def _of_remainder(self, left: Array, spreads: Spreads) -> tuple[float, Spreads]:
        """Return the logarithm of the evidence of a remainder, and the spreads of noise and discrepancy that maximise it."""
        linear = Linearisation(None, {}, left, np.zeros((left.size, 0)), ())
        return LinearEvidence(linear, self.basis).estimated((), spreads, self.correlation_time, sweeps=3)

    def spreads_of(self, plain: FittedModel, near: Spreads) -> Spreads:
        """Return the spreads of what a fit leaves, estimated from others near them.

        Not those that a subset was weighed with: a shape between those of its terms is no discrepancy.
        """
        return self._of_remainder(plain.fit.residual, near)[1]
