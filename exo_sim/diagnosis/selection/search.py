"""The search for the effects that the data support: scored by their signatures, confirmed by full fits, pruned, then assessed.

A score test projects each candidate's signature clear of the fitted parameters; the best few are fitted. Several sets are grown side by
side until one reaches the noise, because the effect that explains most alone need not be one of the two that are there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.estimation.least_squares import FEWEST_ROWS, Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.policy import gates
from exo_sim.diagnosis.policy.budgets import (
    BEAM,
    FIRST_LOOKED,
    LARGE,
    MOST_EXTENSIONS,
    MOST_FINDINGS,
    MOST_JOINT,
    MOST_SWAPS,
    STRAY,
    WORTH_A_ROUND,
)
from exo_sim.diagnosis.selection.assessment import assess
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import (
    FittedModel,
    LeastSquaresModel,
    SearchResult,
    SetKey,
    is_more_than_healthy,
    key_of,
)
from exo_sim.diagnosis.selection.joint_proposal import Proposal, joint_proposals
from exo_sim.diagnosis.selection.joint_pruning import jointly_pruned
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals


class Search:
    """A search over one subsystem.

    Args:
        model: The subsystem.
        nuisances: Nuisance parameters, refitted in every comparison.
        candidates: What may be found.
        threads: Threads; the result does not depend on how many.
        progress: Called with a few words on what is going on.
        most: The most findings.
        cheap: Whether predictions cost little: then all promising candidates are fitted, from scratch, and simpler ones tried.
        practical_significance: Drop of the root mean square residual, in units of the noise, below which nothing is a finding.
        until: Of a model that does not explain everything, whether to stop the search there.
        is_spent: Whether the time is up: then nothing more is sought, and what was found is assessed.
    """

    def __init__(
        self,
        model: LeastSquaresModel,
        nuisances: Sequence[FreeParameter],
        candidates: Sequence[Candidate],
        threads: Threads = SERIAL,
        progress: Callable[[str], None] | None = None,
        most: int = MOST_FINDINGS,
        cheap: bool = False,
        practical_significance: float = 0.0,
        until: Callable[[FittedModel], bool] | None = None,
        is_spent: Callable[[], bool] | None = None,
    ):
        self.fits = ModelFits(model, nuisances, threads, cheap)
        self.proposals = Proposals(self.fits, candidates, practical_significance)
        self._most, self._practical_significance = most, practical_significance
        self._report = progress or (lambda words: None)
        self._until = until or (lambda model: False)
        self._is_spent = is_spent or (lambda: False)

    def run(self) -> SearchResult:
        """Grow sets side by side, swap and prune, then assess every finding and its rivals."""
        self._report("refitting nuisance parameters")
        if self.fits.model.size < FEWEST_ROWS:
            empty = FittedModel((), Fit((), {}, np.zeros(0), np.zeros((0, 0))))
            return SearchResult(empty, empty)
        baseline = self.fits.refined(self.fits.fit(()))
        comparisons = Comparisons(self.fits, baseline, len(self.proposals.candidates), self._practical_significance)
        return _Growth(self.fits, comparisons, self.proposals, self._report, self._until, self._is_spent).run(self._most)


class _Growth:
    """One run of a search, from its baseline."""

    def __init__(
        self, fits: ModelFits, comparisons: Comparisons, proposals: Proposals, report: Callable[[str], None],
        until: Callable[[FittedModel], bool], is_spent: Callable[[], bool] = lambda: False,
    ):  # fmt: skip
        self.fits, self.comparisons, self.proposals = fits, comparisons, proposals
        self._report, self._until, self._is_spent = report, until, is_spent

    def run(self, most: int) -> SearchResult:
        """Return the result with at most so many findings."""
        best = self.comparisons.baseline
        beam, together = [best], False
        for _ in range(most):
            if self._is_spent():
                break
            self._report(f"scoring {len(self.proposals.candidates)} candidates")
            grown = self._grown(beam)
            if not grown:
                break
            leader = self._leader(grown)
            ordered = [leader, *(model for model in self.comparisons.ranked(grown) if model is not leader)]
            tidied = next((model for model in map(self._tidied, ordered) if model.candidates), None)
            if tidied is None or (best.candidates and self.fits.deficit(tidied, best) >= 0.0):
                break
            before, best = best, tidied
            self._report(f"{len(best.candidates)} found, {best.candidates[-1].effect.replace('_', ' ')} last")
            if not self.comparisons.is_clean(best) and self._until(best):
                return SearchResult(self.comparisons.baseline, self.fits.refined(best), interrupted=True)
            if not self.comparisons.is_clean(best) and not together:
                together, reached = True, self._from_all_at_once(best)
                if reached is not best:
                    best = reached
                    if self._until(best):
                        return SearchResult(self.comparisons.baseline, self.fits.refined(best), interrupted=True)
                    break
            if self._is_hopeless(before, best):
                break
            beam = [best]
            if not self.comparisons.is_clean(best):
                beam += [model for model in self.comparisons.ranked(grown) if model.named not in (best.named, leader.named)][: BEAM - 1]
        found = self._assessed(best)
        for _ in range(MOST_SWAPS):
            if self._is_spent():
                break
            better = self._overtaken(found)
            if better is None:
                break
            found = self._assessed(better)
        return found

    def _from_all_at_once(self, now: FittedModel) -> FittedModel:
        """Return a model that is reached by asking all candidates together, and leaving out what is not missed.

        Proposals are made beside the model that there is, and where that leads nowhere, beside none. The result counts only where it
        explains the data as far as the model of a healthy machine would; else the model stays that it came from.
        """
        reached = self._reached_from(now)
        if not self._is_healthy(reached) and not self._is_spent():
            reached = self._reached_from(self.comparisons.baseline)
        tidied = self._tidied(reached) if self._is_healthy(reached) else now
        return tidied if self._is_healthy(tidied) and self.fits.deficit(tidied, now) < 0.0 else now

    def _is_healthy(self, model: FittedModel) -> bool:
        """Return whether no more is left than the model of a healthy machine leaves."""
        bound = self.fits.model.discrepancy_bound
        return self.comparisons.is_clean(model) or model.fit.sse < bound * bound * self.fits.model.size

    def _reached_from(self, now: FittedModel) -> FittedModel:
        """Return the model that proposals of several candidates at once lead to, without what is not missed in the end."""
        model, threads = self.fits.model, self.fits.threads
        best = now
        for _ in range(MOST_JOINT):
            if self._is_spent():
                break
            self._report(f"weighing {len(self.proposals.candidates)} candidates together")
            fitted = [self._proposed(best, one) for one in joint_proposals(model, best, self.proposals.candidates, threads)]
            if not fitted:
                break
            richer = min(fitted, key=lambda one: one.fit.sse)
            if richer.fit.sse > (1.0 - WORTH_A_ROUND) * best.fit.sse:
                break
            best = self.fits.refined(richer)
            self._report(f"{len(best.candidates)} together, {math.sqrt(best.fit.sse / model.size):.1f} times the noise left")
            if self.comparisons.is_clean(best):
                break
        return self._extended(self._jointly_pruned(best))

    def _jointly_pruned(self, now: FittedModel) -> FittedModel:
        """Return a model without what is not missed beside the rest."""
        while now.candidates:
            kept = jointly_pruned(self.fits.model, now, self.fits.threads)
            if len(kept) == len(now.candidates):
                break
            now = self.fits.refined(self.fits.fit(kept, now))
            self._report(f"{len(now.candidates)} worth their parameters")
        return now

    def _extended(self, now: FittedModel) -> FittedModel:
        """Return a model with what a whole fit finds beside it: an effect whose signature is not in proportion to its size is not
        proposed with the others.
        """
        for _ in range(MOST_EXTENSIONS):
            if self.comparisons.is_clean(now) or self._is_spent():
                break
            asked = self.proposals.additions(now)
            self._report(f"{len(asked)} more to be fitted beside {len(now.candidates)}")
            looks = [self.fits.look((*now.candidates, one), now) for one in asked]
            close = self.comparisons.ranked(looks)[:FIRST_LOOKED] if looks else []
            models = self.fits.fit_all([(model.candidates, model) for model in close])
            shown = [
                model for model in models
                if is_more_than_healthy(model.candidates[-1], model)
                and self.comparisons.evidence(now, model).beside_discrepancy > gates.BESIDE_DISCREPANCY
            ]  # fmt: skip
            if not shown:
                break
            now = self._jointly_pruned(self.fits.refined(self.comparisons.ranked(shown)[0]))
        return now

    def _proposed(self, now: FittedModel, proposal: Proposal) -> FittedModel:
        """Return the fit of a model with what is proposed beside it, less what leads astray where it stands: sizes add up only nearly."""
        model, added = self.fits.model, proposal.candidates

        def misfit(more: Sequence[Candidate]) -> float:
            values = {**now.fit.values, **{q: proposal.values[q] for one in more for q in one.parameters}}
            residual = model.residual(values, [pair for one in (*now.candidates, *more) for pair in one.fixed])
            return float(residual @ residual) if np.isfinite(residual).all() else math.inf

        here = misfit(added)
        while added and here > STRAY * now.fit.sse:
            fewer = [drop_orphans(tuple(c for c in added if c is not one), self._standing(now)) for one in added]
            tried = self.fits.threads.predictions(misfit, fewer)
            best = int(np.argmin(tried))
            here, added = tried[best], fewer[best]
        near = FittedModel(now.candidates, replace(now.fit, values={**now.fit.values, **proposal.values}))
        return self.fits.fit((*now.candidates, *added), near) if added else now

    @staticmethod
    def _standing(model: FittedModel) -> set[str]:
        return {candidate.effect for candidate in model.candidates}

    def _assessed(self, model: FittedModel) -> SearchResult:
        """Return the result of ending with what a model keeps when it is pruned."""
        settled = self._settled(self.fits.refined(self._pruned(model)))
        return assess(settled, self.fits, self.comparisons, self.proposals, self._is_spent())

    def _is_hopeless(self, before: FittedModel, now: FittedModel) -> bool:
        """Return whether a further effect helped little against an error that no effect explains: another machine's recording."""
        size = self.fits.model.size
        left = math.sqrt(now.fit.sse / size)
        lowered = math.sqrt(before.fit.sse / size) - left
        return len(now.candidates) > 1 and left > gates.HOPELESS_SEARCH * self.fits.model.discrepancy_bound and lowered < left

    def _tidied(self, model: FittedModel) -> FittedModel:
        """Return a set in its simplest form, without what does not stand beside the rest."""
        return self._simplest(self._pruned(self._swapped(model) if self.fits.cheap else model))

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
        if worse > -gates.SWAP_GAIN:
            return None
        now = found.final
        sets = [drop_orphans((*now.without(candidate), rival)), (*now.candidates, rival)]
        better = self.comparisons.ranked([now, *self.fits.fit_all([(one, now) for one in sets])])[0]
        return None if better is now else better

    def _grown(self, beam: Sequence[FittedModel]) -> list[FittedModel]:
        """Return every accepted set that has one candidate more than one of these."""
        asked = [(now, candidate) for now in beam for candidate in self.proposals.additions(now)]
        grown: dict[SetKey, FittedModel] = {}
        models = self.fits.fit_all([((*now.candidates, one), now) for now, one in asked])
        for (now, candidate), model in zip(asked, models, strict=True):
            if self.comparisons.accepts(now, model) and is_more_than_healthy(candidate, model):
                grown[key_of(model.candidates)] = model
        return list(grown.values())

    def _leader(self, grown: Sequence[FittedModel]) -> FittedModel:
        """Return the best of these sets; of two that explain nearly the same, the one with fewer parameters."""
        best = self.comparisons.ranked(grown)[0]
        simpler = [
            one
            for one in grown
            if one.parameter_count < best.parameter_count
            and self.comparisons.explains(one, best, gates.NEARLY_AS_MUCH)
            and self.fits.deficit(one, best) < gates.NO_WORSE
        ]
        return self.comparisons.ranked(simpler)[0] if simpler else best

    def _swapped(self, now: FittedModel) -> FittedModel:
        """Try, for every finding, whether another candidate in its place explains more."""
        for index in range(len(now.candidates)):
            kept = now.without(now.candidates[index])
            base = self.fits.fit(kept, now)
            for candidate in self.proposals.alternatives(base):
                if candidate.at in now.named or len(drop_orphans((*kept, candidate))) <= len(kept):
                    continue
                model = self.fits.fit((*kept, candidate), base)
                if self.fits.deficit(model, now) < -gates.SWAP_GAIN - gates.SWAP_GAIN * max(model.parameter_count - now.parameter_count, 0):
                    now = model
                    break
        return now

    def _pruned(self, now: FittedModel) -> FittedModel:
        """Leave out what does not pass the gates any more beside the others."""
        shrunk = True
        while shrunk and now.candidates:
            shrunk = False
            apart = [c for c in now.candidates if len(drop_orphans(now.without(c))) == len(now.without(c))]
            bare = self._without_each(now, apart)
            for candidate, without in zip(apart, bare, strict=True):
                if not self.comparisons.accepts(without, now, stands=True) or not is_more_than_healthy(candidate, now):
                    now, shrunk = without, True
                    break
        return now

    def _without_each(self, now: FittedModel, apart: Sequence[Candidate]) -> list[FittedModel]:
        """Return a model without each of these: of a large one a first look suffices where plainly more is left."""
        asked = [(now.without(c), now) for c in apart]
        if len(now.candidates) < LARGE:
            return self.fits.fit_all(asked, again=True)
        return self.fits.fit_near(asked, now)

    def _settled(self, now: FittedModel) -> FittedModel:
        """Leave out parameters, and whole findings, that the data do not distinguish from neutral.

        Parameters that are vague only because they stand in for each other stay.
        """
        while now.candidates:
            if not all(is_more_than_healthy(c, now) for c in now.candidates):  # the last refinement made one healthy
                fewer = self._pruned(now)
                if fewer is not now:
                    now = self.fits.refined(fewer)
                    continue
            errors = self.fits.standard_errors(now)
            vague = {
                q for c in now.candidates for q in c.parameters if abs(now.fit.values[q] - q.neutral) < gates.CERTAIN * errors.get(q, 0.0)
            }
            simpler = self._without_vague(now, vague)
            if simpler is None:
                break
            now = self.fits.refined(self._pruned(simpler))
        return now

    def _without_vague(self, now: FittedModel, vague: set[FreeParameter]) -> FittedModel | None:
        """Return a set with less of what is vague in it, None where there is none."""
        for candidate in now.candidates:
            others = now.without(candidate)
            clear = {q.parameter for q in candidate.parameters if q not in vague}
            if len(clear) == len(candidate.parameters) or len(drop_orphans(others)) < len(others):
                continue
            if len(candidate.parameters) == 1:
                model = self.fits.fit(others, now)
                if self.fits.deficit(model, now) < gates.VAGUE_LOSS:
                    return model
                continue
            for form in self.proposals.simpler(candidate, now, clear):
                model = self.fits.fit((*others, form), now)
                if self.comparisons.is_as_good(model, now):
                    return model
        return None

    def _simplest(self, now: FittedModel) -> FittedModel:
        """Put each finding in the form that needs fewest parameters for what it explains; where fits are cheap, or a simpler effect."""
        for candidate in now.candidates:
            best = now
            forms = self.proposals.replacements(candidate, now)
            sets = [tuple(form if c.key == candidate.key else c for c in now.candidates) for form in forms]
            fit_all = self.fits.fit_all if len(now.candidates) < LARGE else lambda asked: self.fits.fit_near(asked, best)  # noqa: B023
            for form, model in zip(forms, fit_all([(chosen, now) for chosen in sets]), strict=True):
                simpler = form.at == candidate.at and model.parameter_count < best.parameter_count
                if self.comparisons.ranked((model, best))[0] is model or (simpler and self.comparisons.is_as_good(model, best)):
                    best = model
            now = best
        return now
