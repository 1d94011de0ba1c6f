"""How the fitted models of one search compare: evidence, what accepts a candidate, and a ranking that charges for parameters."""

from __future__ import annotations

from collections.abc import Sequence

from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.selection.evidence import Evidence, compare, is_accepted, negative_log_likelihood, price_of_parameter
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.model_fits import ModelFits


class Comparisons:
    """Comparisons between models of one subsystem.

    Args:
        fits: Their fits.
        baseline: The nuisance parameters alone.
        candidates: How many candidates there are.
        practical_significance: Drop of the root mean square residual, in units of the noise, below which nothing is a finding.
    """

    def __init__(self, fits: ModelFits, baseline: FittedModel, candidates: int, practical_significance: float):
        self.fits, self.baseline = fits, baseline
        self._candidates, self._practical_significance = candidates, practical_significance

    def moves_baseline(self) -> bool:
        """Take what is known to be the best fit of the nuisance parameters alone as the baseline; return whether it is another one.

        Alone they may end in an optimum where numbers stand in for an effect, far off their data sheets. A fit with an effect leads them
        out of it, and where that is left out again, they leave less than they did before.
        """
        known = self.fits.fit((), self.baseline)
        if self.fits.deficit(known, self.baseline) >= -acceptance.SWAP_GAIN:
            return False
        self.baseline = self.fits.refined(known)
        return True

    def evidence(self, without: FittedModel, with_it: FittedModel) -> Evidence:
        """Return how much better `with_it` explains the training data than `without`."""
        added = with_it.parameter_count - without.parameter_count
        return compare(self.fits.model, without.fit, with_it.fit, added, self._candidates)

    def accepts(self, without: FittedModel, with_it: FittedModel, stands: bool = False) -> bool:
        """Return whether what `with_it` has more passes every gate; of what `stands` in a model already less is asked."""
        evidence = self.evidence(without, with_it)
        return is_accepted(evidence, self.baseline.fit, without.fit, with_it.fit, self._practical_significance, stands)

    def price(self, models: Sequence[FittedModel]) -> float:
        """Return the log-likelihood that one more parameter must bring, on the independent rows of the best of these."""
        return price_of_parameter(self.fits.effective_sample_size(models))

    def ranked(self, models: Sequence[FittedModel]) -> list[FittedModel]:
        """Return models by log-likelihood less the price of their parameters, best first."""
        rows, price = self.fits.effective_sample_size(models), self.price(models)
        return sorted(models, key=lambda model: negative_log_likelihood(model.fit, rows) + price * model.parameter_count)

    def is_clean(self, model: FittedModel) -> bool:
        """Return whether the residual is as small as the noise."""
        return model.fit.sse < acceptance.CLEAN * self.fits.model.size

    def is_as_good(self, one: FittedModel, other: FittedModel) -> bool:
        """Return whether a simpler model explains nearly all that the other does, or hardly less in log-likelihood."""
        return self.explains(one, other, acceptance.AS_MUCH) or self.fits.deficit(one, other) < acceptance.NO_WORSE

    def explains(self, one: FittedModel, other: FittedModel, share: float) -> bool:
        """Return whether a model explains more than this share of what the other explains beyond the baseline."""
        whole = self.baseline.fit.sse
        return whole - one.fit.sse > share * (whole - other.fit.sse)
