"""The search for the effects that the data support, one after the other: scored by their signatures, fitted, pruned, then assessed.

A score test projects each candidate's signature clear of the fitted parameters; the best few are fitted. Several sets are grown side by
side until one reaches the noise, because the effect that explains most alone need not be one of the two that are there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.policy.budgets import BEAM, MOST_FINDINGS, MOST_FURTHER, MOST_SWAPS
from exo_sim.diagnosis.policy.recordings import FEWEST_ROWS
from exo_sim.diagnosis.selection.assessment import assess
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import (
    FittedModel,
    LeastSquaresModel,
    SearchResult,
    SetKey,
    is_at_bound,
    is_more_than_healthy,
    key_of,
)
from exo_sim.diagnosis.selection.further_forms import with_further_forms
from exo_sim.diagnosis.selection.joint_search import JointSearch, Together
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals
from exo_sim.diagnosis.selection.simplification import Simplification


@dataclass(frozen=True)
class StoppingCriteria:
    """What ends a search before every candidate was asked.

    Attributes:
        until: Of a model that does not explain everything, whether to stop there, for another subsystem to be asked first.
        is_spent: Whether the time is up: then whatever goes on ends with what it has, and what was found is assessed.
        is_enough: Whether so much was tried that nothing more is sought; what was begun is ended.
    """

    until: Callable[[FittedModel], bool] | None = None
    is_spent: IsSpent = never
    is_enough: IsSpent = never


@dataclass(frozen=True)
class WarmStart:
    """Where a search begins.

    Attributes:
        first: A fit of the nuisance parameters, or of most of them; None for their typical values.
        begun: A model of other rows of the same subsystem, of which only candidates and values count; None for no candidate.
        asks_together: Of a model that leaves something, whether all candidates are asked together beside it: not where a search before,
            which it begins with what was found by, had the same answer to that.
    """

    first: Fit | None = None
    begun: FittedModel | None = None
    asks_together: Callable[[FittedModel], bool] = lambda _: True


class Search:
    """A search over one subsystem.

    Args:
        model: The subsystem.
        nuisances: Nuisance parameters, refitted in every comparison.
        candidates: What may be found.
        threads: Threads; the result does not depend on how many.
        progress: Called with a few words on what is going on.
        cheap: Whether predictions cost little: then all promising candidates are fitted, from scratch, and simpler ones tried.
        practical_significance: Drop of the root mean square residual, in units of the noise, below which nothing is a finding.
        stopping: What ends it early.
        start: Where it begins.
    """

    def __init__(
        self,
        model: LeastSquaresModel,
        nuisances: Sequence[FreeParameter],
        candidates: Sequence[Candidate],
        threads: Threads = SERIAL,
        progress: Callable[[str], None] | None = None,
        *,
        cheap: bool = False,
        practical_significance: float = 0.0,
        stopping: StoppingCriteria = StoppingCriteria(),
        start: WarmStart = WarmStart(),
    ):
        self.fits = ModelFits(model, nuisances, threads, cheap, stopping.is_spent)
        self.proposals = Proposals(self.fits, candidates, practical_significance)
        self._candidates, self._practical_significance, self._stopping, self._start = candidates, practical_significance, stopping, start
        self._report = progress or (lambda words: None)

    def run(self) -> SearchResult:
        """Return what growing sets side by side, swapping and pruning ends with, every finding assessed against its rivals."""
        self._report("refitting nuisance parameters")
        if self.fits.model.size < FEWEST_ROWS:
            empty = FittedModel.at({})
            return SearchResult(empty, empty)
        near = None if self._start.first is None else FittedModel((), self._start.first)
        baseline = self.fits.refined(self.fits.fit((), near))
        comparisons = Comparisons(self.fits, baseline, len(self.proposals.candidates), self._practical_significance)
        return _Growth(self.fits, comparisons, self.proposals, self._report, self._stopping).run(self._start)

    def shown_beside(self, found: SearchResult, fits: ModelFits) -> SearchResult:
        """Return a result with what shows beside its model, where something is left.

        Args:
            found: Of this search, its model changed since.
            fits: The fits that the model belongs to.
        """
        proposals = Proposals(fits, self._candidates, self._practical_significance)
        comparisons = Comparisons(fits, found.baseline, len(proposals.candidates), self._practical_significance)
        return _Growth(fits, comparisons, proposals, self._report, self._stopping).shown_beside(found)


class _Growth:
    """One run of a search, from its baseline."""

    def __init__(
        self, fits: ModelFits, comparisons: Comparisons, proposals: Proposals, report: Callable[[str], None], stopping: StoppingCriteria
    ):
        self.fits, self.comparisons, self.proposals = fits, comparisons, proposals
        self._report, self._stopping = report, stopping
        self.simplification = Simplification(fits, comparisons, proposals, self._is_over)
        self.joint = JointSearch(fits, comparisons, proposals, self.simplification, report, self._is_over, self._goes_elsewhere)

    def _is_over(self) -> bool:
        """Return whether nothing more is to be sought."""
        return self._stopping.is_enough() or self.fits.is_spent()

    def run(self, start: WarmStart) -> SearchResult:
        """Return the result, with at most `MOST_FINDINGS` more than what stands of a model to begin with."""
        begun = start.begun if start.begun is not None and start.begun.candidates else None
        best = self._standing_of(begun) if begun is not None else self.comparisons.baseline
        beam = [best]
        together: Together | None = None
        again = False
        for _ in range(MOST_FINDINGS):
            if self._is_over():
                break
            self._report(f"scoring {len(self.proposals.candidates)} candidates")
            grown = self._grown_further(beam, again, self._grown(beam, again))
            leader = self._leader(grown) if grown else best
            ordered = [leader, *(model for model in self.comparisons.ranked(grown) if model is not leader)] if grown else []
            tidied = next((model for model in map(self.simplification.tidied, ordered) if model.candidates), None)
            if tidied is None and not best.candidates and self.comparisons.moves_baseline():
                best, again = self.comparisons.baseline, True
                beam = [best]
                continue
            if tidied is None:
                if together is None and start.asks_together(best) and not self.joint.is_within_bound(best):
                    together = self.joint.found_together(best)
                    if self._ends_with(together):
                        return self._reached(together.model)
                break
            if best.candidates and self.fits.deficit(tidied, best) >= 0.0:
                break
            before, best = best, tidied
            self._report(f"{len(best.candidates)} found, {best.candidates[-1].effect.replace('_', ' ')} last")
            if not self.comparisons.is_clean(best) and self._goes_elsewhere(best):
                return self._interrupted(best)
            if together is None and start.asks_together(best) and not self.comparisons.is_clean(best):
                if (elsewhere := self._elsewhere_next(best)) is not None:
                    return self._interrupted(elsewhere)
                together = self.joint.found_together(best)
                if self._ends_with(together):
                    return self._reached(together.model)
            if self._gives_up(before, best):
                return self._swapped(best)
            beam = [best]
            if not self.comparisons.is_clean(best):
                beam += [model for model in self.comparisons.ranked(grown) if model.named not in (best.named, leader.named)][: BEAM - 1]
        return self._swapped(self._gone_on(self._nearer(self._completed(best), together)))

    def shown_beside(self, found: SearchResult) -> SearchResult:
        """Return a result with what shows beside its model, one after the other; what stands in it stays in its form."""
        best = found.final
        for _ in range(MOST_FURTHER):
            grown = [] if self.comparisons.is_clean(best) or self._is_over() else self._grown([best])
            if not grown:
                break
            best = self._leader(grown)
        return found if best is found.final else replace(self._assessed(best), stands_for=found.stands_for)

    def _nearer(self, best: FittedModel, together: Together | None) -> FittedModel:
        """Return what was found together where that explains more than what was found one at a time: one hides the other there.

        Something is left of it: its names then stand beside something unknown, by the harder rule (`decision`).
        """
        if together is None or not together.model.candidates or self.comparisons.is_clean(best):
            return best
        one = together.model
        return one if self.fits.deficit(one, best) < 0.0 and self.comparisons.accepts(best, one) else best

    def _ends_with(self, together: Together) -> bool:
        """Return whether the search ends with what was asked together: it explains the data, or another subsystem is to be asked first."""
        return together.explains or self._goes_elsewhere(together.model)

    def _reached(self, together: FittedModel) -> SearchResult:
        """Return the result of a search that ends with what was asked together, unless another subsystem is to be asked first."""
        return self._interrupted(together) if self._goes_elsewhere(together) else self._swapped(self._gone_on(together))

    def _interrupted(self, model: FittedModel) -> SearchResult:
        """Return the result of a search that stops at a model for another subsystem to be asked first: nothing of it is assessed."""
        return SearchResult(self.comparisons.baseline, self.fits.refined(model), interrupted=True)

    def _standing_of(self, begun: FittedModel) -> FittedModel:
        """Return what these rows accept of a model of other rows, fitted to these; the baseline where that is nothing."""
        self._report(f"asking {len(begun.candidates)} found before")
        near = FittedModel.at(begun.fit.values)
        standing = self.simplification.tidied(self.fits.refined(self.fits.fit(begun.candidates, near)))
        return standing if standing.candidates else self.comparisons.baseline

    def _completed(self, now: FittedModel) -> FittedModel:
        """Return a model with further effects that explain the larger part of what is left together and none of them alone, if any do."""
        if not now.candidates or self.comparisons.is_clean(now) or self._is_over():
            return now
        more = self.joint.extended(now)
        if len(more.candidates) <= len(now.candidates):
            return now
        tidied = self.simplification.tidied(more)
        return tidied if len(tidied.candidates) > len(now.candidates) and self.comparisons.accepts(now, tidied) else now

    def _gone_on(self, now: FittedModel) -> FittedModel:
        """Return a model that leaves something with its findings in the further forms that are accepted, and what shows beside these alone.

        They are asked where a search ends: before, what is left is mostly of what was not found yet. Where a law alone is new beside what a
        healthy machine leaves, no further name is sought: it would be of what another law gets wrong.
        """
        for _ in range(MOST_FURTHER):
            if self.comparisons.is_clean(now) or self._is_over():
                break
            richer = with_further_forms(now, self.fits, self.comparisons, self.proposals)
            if richer is now:
                break
            is_law_alone = set(now.candidates) <= set(richer.candidates) and self.joint.is_within_bound(now)
            refined = self.fits.refined(richer)
            now = refined if is_law_alone else self._completed(refined)
        return now

    def _swapped(self, best: FittedModel) -> SearchResult:
        """Return the assessed result of a model in which rivals that explain more took the places of findings."""
        found = self._assessed(best)
        for _ in range(MOST_SWAPS):
            if self._is_over():
                break
            better = self._overtaken(found)
            if better is None:
                break
            if not self._is_over():  # what an effect that stands gets wrong in its form is no reason for the name of another
                richer = with_further_forms(found.final, self.fits, self.comparisons, self.proposals, instead=True)
                better = self.comparisons.ranked([better, richer])[0] if richer is not found.final else better
            found = self._assessed(better)
        return found

    def _goes_elsewhere(self, model: FittedModel) -> bool:
        """Return whether the search stops at a model for another subsystem to be asked first, and there is time to."""
        until = self._stopping.until
        return until is not None and until(model) and not self.fits.is_spent()

    def _elsewhere_next(self, best: FittedModel) -> FittedModel | None:
        """Return the model with one finding more where the search would stop at that for another subsystem, else None.

        What asking all candidates together costs is saved then: the search begins anew with what the other subsystem says.
        """
        if self._stopping.until is None or self._is_over():
            return None
        grown = self._grown([best])
        if not grown or not self._goes_elsewhere(leader := self._leader(grown)):
            return None
        tidied = self.simplification.tidied(leader)
        further = tidied.candidates and self.fits.deficit(tidied, best) < 0.0 and not self.comparisons.is_clean(tidied)
        return tidied if further and self._goes_elsewhere(tidied) else None

    def _assessed(self, model: FittedModel) -> SearchResult:
        """Return the result of ending with what a model keeps when it is pruned."""
        settled = self.simplification.settled(self.fits.refined(self.simplification.pruned(model)))
        return assess(self.simplification.off_bounds(settled), self.fits, self.comparisons, self.proposals, self._is_over())

    def _gives_up(self, before: FittedModel, now: FittedModel) -> bool:
        """Return whether a further effect helped little against an error that no effect explains: another machine's recording."""
        size = self.fits.model.size
        left = math.sqrt(now.fit.sse / size)
        lowered = math.sqrt(before.fit.sse / size) - left
        return len(now.candidates) > 1 and left > acceptance.HOPELESS_SEARCH * self.fits.model.discrepancy_bound and lowered < left

    def _overtaken(self, found: SearchResult) -> FittedModel | None:
        """Return the set with the best rival in a finding's place, where that explains more."""
        by_loss = [
            (worse, candidate, rival)
            for candidate in found.final.candidates
            for rival, worse in found.rivals[candidate.key][:1]
            if rival.at not in found.final.named
        ]
        if not by_loss:
            return None
        worse, candidate, rival = min(by_loss, key=lambda one: one[0])
        if worse > -acceptance.SWAP_GAIN:
            return None
        now = found.final
        sets = [drop_orphans((*now.without(candidate), rival)), (*now.candidates, rival)]
        better = self.comparisons.ranked([now, *self.fits.fit_all([(one, now) for one in sets])])[0]
        return None if better is now else better

    def _grown_further(self, beam: Sequence[FittedModel], again: bool, grown: list[FittedModel]) -> list[FittedModel]:
        """Return sets that grew, with those by the candidates of the next scores where the former leave the larger part of an error.

        A score is what a small size of an effect promises along a line. Beside an error that other effects bend as well it may be a
        third of what a fit gains. Where no more is left than a healthy machine leaves, nothing further is asked.
        """
        least = min((model.fit.sse for model in grown), default=math.inf)
        left = [now for now in beam if least > acceptance.SHARE_OF_THE_REST * now.fit.sse and not self.joint.is_within_bound(now)]
        return grown + self._grown(left, again, later=True)

    def _grown(self, beam: Sequence[FittedModel], again: bool = False, later: bool = False) -> list[FittedModel]:
        """Return every accepted set that has one candidate more than one of these; `again` as of `ModelFits.fit`."""
        asked = [(now, candidate) for now in beam for candidate in self.proposals.additions(now, later)]
        grown: dict[SetKey, FittedModel] = {}
        models = self.fits.fit_rivals([((*now.candidates, one), now) for now, one in asked], again=again)
        for (now, candidate), model in zip(asked, models, strict=True):
            found = is_more_than_healthy(candidate, model) and not is_at_bound(candidate, model)
            if found and self.comparisons.accepts(now, model):
                grown[key_of(model.candidates)] = model
        return list(grown.values())

    def _leader(self, grown: Sequence[FittedModel]) -> FittedModel:
        """Return the best of these sets; of two that explain nearly the same, the one with fewer parameters."""
        best = self.comparisons.ranked(grown)[0]
        simpler = [
            one
            for one in grown
            if one.parameter_count < best.parameter_count
            and self.comparisons.explains(one, best, acceptance.NEARLY_AS_MUCH)
            and self.fits.deficit(one, best) < acceptance.NO_WORSE
        ]
        return self.comparisons.ranked(simpler)[0] if simpler else best
