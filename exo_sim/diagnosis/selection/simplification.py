"""A model with no more in it than the data support: findings left out, exchanged, or put in a form with fewer parameters."""

from __future__ import annotations

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, is_at_bound, is_more_than_healthy
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals


class Simplification:
    """Simpler models of one subsystem.

    Args:
        fits: Fits of its models.
        comparisons: Between them.
        proposals: Forms and rivals of its candidates.
        is_over: Whether nothing more is to be sought.
    """

    def __init__(self, fits: ModelFits, comparisons: Comparisons, proposals: Proposals, is_over: IsSpent = never):
        self.fits, self.comparisons, self.proposals, self._is_over = fits, comparisons, proposals, is_over

    def tidied(self, model: FittedModel) -> FittedModel:
        """Return a model in its simplest form, without what would not be accepted beside the rest."""
        return self._simplest(self.pruned(self._swapped(model) if self.fits.cheap and not self._is_over() else model))

    def _swapped(self, now: FittedModel) -> FittedModel:
        """Return a model in which candidates that explain more took the places of findings."""
        for index in range(len(now.candidates)):
            kept = now.without(now.candidates[index])
            base = self.fits.fit(kept, now)
            for candidate in self.proposals.alternatives(base):
                if self._is_over():
                    return now
                if candidate.at in now.named or len(drop_orphans((*kept, candidate))) <= len(kept):
                    continue
                model = self.fits.fit((*kept, candidate), base)
                more = max(model.parameter_count - now.parameter_count, 0)
                if self.fits.deficit(model, now) < -acceptance.SWAP_GAIN - acceptance.SWAP_GAIN * more:
                    now = model
                    break
        return now

    def pruned(self, now: FittedModel) -> FittedModel:
        """Return a model without what would not be accepted any more beside the others; the least missed is left out first."""
        shrunk = True
        while shrunk and now.candidates and not self.fits.is_spent():
            shrunk = False
            apart = [c for c in now.candidates if len(drop_orphans(now.without(c))) == len(now.without(c))]
            for candidate, without in self.fits.each_without(apart, now):
                if not self.comparisons.accepts(without, now, stands=True) or not is_more_than_healthy(candidate, now):
                    now, shrunk = without, True
                    break
        return now

    def settled(self, now: FittedModel) -> FittedModel:
        """Return a model without the parameters, and whole findings, that the data do not distinguish from neutral.

        Parameters that are vague only because they stand in for each other stay. So do those without which a finding would not be accepted
        any more: a simpler form that explains about as much is no reason to lose what the richer one was accepted for.
        """
        while now.candidates and not self.fits.is_spent():
            if not all(is_more_than_healthy(c, now) for c in now.candidates):  # the last refinement made one healthy
                fewer = self.pruned(now)
                if fewer is not now:
                    now = self.fits.refined(fewer)
                    continue
            errors = self.fits.standard_errors(now)
            vague = {
                q
                for c in now.candidates
                for q in c.parameters
                if abs(now.fit.values[q] - q.neutral) < acceptance.CERTAIN * errors.get(q, 0.0)
            }
            simpler = self._without_vague(now, vague)
            if simpler is None:
                break
            now = self.fits.refined(self.pruned(simpler))
        return now

    def off_bounds(self, now: FittedModel) -> FittedModel:
        """Return a model whose findings that ended at a bound have another form of theirs that does not, where one is accepted.

        A number at the end of its range is no finding, yet the law may go on in a form with one number more: what no ellipse follows an
        exponent does.
        """
        for candidate in [one for one in now.candidates if is_at_bound(one, now)]:
            if self.fits.is_spent():
                break
            without = self.fits.fit(drop_orphans(now.without(candidate)), now)
            forms = self.proposals.forms_of(candidate)
            sets = [tuple(form if one is candidate else one for one in now.candidates) for form in forms]
            models = zip(forms, self.fits.fit_rivals([(chosen, now) for chosen in sets], now), strict=True)
            inside = [model for form, model in models if not is_at_bound(form, model)]
            shown = [model for model in inside if self.comparisons.accepts(without, model, stands=True)]
            if shown:
                now = self.fits.refined(self.comparisons.ranked(shown)[0])
        return now

    def _without_vague(self, now: FittedModel, vague: set[FreeParameter]) -> FittedModel | None:
        """Return a model with fewer vague parameters, None where there is none as good."""
        for candidate in now.candidates:
            others = now.without(candidate)
            clear = {q.parameter for q in candidate.parameters if q not in vague}
            if len(clear) == len(candidate.parameters) or len(drop_orphans(others)) < len(others):
                continue
            if len(candidate.parameters) == 1:
                model = self.fits.fit(others, now)
                if self.fits.deficit(model, now) < acceptance.VAGUE_LOSS:
                    return model
                continue
            for form in self.proposals.simpler(candidate, now, clear):
                model = self.fits.fit((*others, form), now)
                if self.comparisons.is_as_good(model, now) and not self._is_lost_in(model, now, candidate):
                    return model
        return None

    def _simplest(self, now: FittedModel) -> FittedModel:
        """Return a model with each finding in the form that needs fewest parameters for what it explains; where fits are cheap, also by a
        simpler effect.
        """
        for candidate in now.candidates:
            if self.fits.is_spent():
                break
            best = now
            forms = self.proposals.replacements(candidate, now)
            sets = [tuple(form if c.key == candidate.key else c for c in now.candidates) for form in forms]
            models = self.fits.fit_rivals([(chosen, now) for chosen in sets], now)
            for form, model in zip(forms, models, strict=True):
                simpler = form.at == candidate.at and model.parameter_count < best.parameter_count
                better = self.comparisons.ranked((model, best))[0] is model or (simpler and self.comparisons.is_as_good(model, best))
                if better and not self._is_lost_in(model, now, candidate):
                    best = model
            now = best
        return now

    def _is_lost_in(self, simpler: FittedModel, now: FittedModel, candidate: Candidate) -> bool:
        """Return whether a finding would not be accepted any more in a form with fewer parameters, and is in the one that it has."""
        if simpler.parameter_count >= now.parameter_count or candidate.at not in simpler.named:
            return False
        without = self.fits.fit(drop_orphans(now.without(candidate)), now)
        return not self.comparisons.accepts(without, simpler, stands=True) and self.comparisons.accepts(without, now, stands=True)
