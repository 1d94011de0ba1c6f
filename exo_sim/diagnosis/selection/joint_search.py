"""Backward elimination: all candidates are asked together, what is proposed is fitted, and what is not missed is left out.

Effects that hide each other pass no gate one at a time. Where what comes out explains the data as far as the model of a healthy machine
would, the search ends with it; else it goes on one at a time, and what was found together is held against what that leads to (`search`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from exo_sim.diagnosis.estimation.budget import IsSpent
from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.policy import acceptance
from exo_sim.diagnosis.policy.budgets import FIRST_LOOKED, MOST_EXTENSIONS, MOST_JOINT, STRAY, WORTH_A_ROUND
from exo_sim.diagnosis.policy.verdicts import LARGER_PART
from exo_sim.diagnosis.selection.comparisons import Comparisons
from exo_sim.diagnosis.selection.fitted_model import FittedModel, is_at_bound, is_more_than_healthy
from exo_sim.diagnosis.selection.joint_proposal import Proposal, joint_proposals
from exo_sim.diagnosis.selection.joint_pruning import jointly_pruned
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.proposals import Proposals
from exo_sim.diagnosis.selection.simplification import Simplification


@dataclass(frozen=True)
class Together:
    """What is found by asking all candidates together.

    Attributes:
        model: Without what is not missed in it.
        explains: Whether it explains the data as far as the model of a healthy machine would.
    """

    model: FittedModel
    explains: bool


class JointSearch:
    """What is reached by asking all candidates of one subsystem together.

    Args:
        fits: Fits of its models.
        comparisons: Between them.
        proposals: The candidates.
        simplification: What leaves a model with no more than it needs.
        report: Called with a few words on what is going on.
        is_over: Whether nothing more is to be sought.
        goes_elsewhere: Whether the search stops at a model for another subsystem to be asked first.
    """

    def __init__(
        self, fits: ModelFits, comparisons: Comparisons, proposals: Proposals, simplification: Simplification,
        report: Callable[[str], None], is_over: IsSpent, goes_elsewhere: Callable[[FittedModel], bool] = lambda _: False,
    ):  # fmt: skip
        self.fits, self.comparisons, self.proposals, self.simplification = fits, comparisons, proposals, simplification
        self._report, self._is_over, self._goes_elsewhere = report, is_over, goes_elsewhere

    def found_together(self, now: FittedModel) -> Together:
        """Return the model that is reached by asking all candidates together, and leaving out what is not missed.

        Proposals are made beside the model that there is, and beside none where that leaves more than the model of a healthy machine
        would: what leads further at once is followed first, the other where that leads nowhere. It does not explain the data where it
        leaves more than the model of a healthy machine would, where what stands of it explains less, or where it is no better than the
        model that there is. Where another subsystem is to be asked first it is returned as it was proposed, without what is not missed.
        """
        begun, bare = self._after_a_round(now), self.comparisons.baseline
        paths = {frozenset(begun.named): (begun, begun is not now)}
        if now.candidates and not self.is_within_bound(begun) and not self._is_over():
            anew = self._after_a_round(bare)
            paths.setdefault(frozenset(anew.named), (anew, anew is not bare))
        first, *others = self.comparisons.ranked([model for model, _ in paths.values()])
        reached = self._reached_from(*paths[frozenset(first.named)])
        for other in others:
            if not (self._goes_elsewhere(reached) or self.is_within_bound(reached) or self._is_over()):
                reached = self.comparisons.ranked([reached, self._reached_from(*paths[frozenset(other.named)])])[0]
        if self._goes_elsewhere(reached):
            return Together(reached, explains=False)
        tidied = self.simplification.tidied(reached)
        if not self.is_within_bound(reached):
            return Together(tidied, explains=False)
        stands = self.is_within_bound(tidied) or self.comparisons.explains(tidied, reached, acceptance.NEARLY_AS_MUCH)
        return Together(tidied, explains=stands and self.fits.deficit(tidied, now) < 0.0)

    def is_within_bound(self, model: FittedModel) -> bool:
        """Return whether no more is left than the model of a healthy machine leaves."""
        bound = self.fits.model.discrepancy_bound
        return self.comparisons.is_clean(model) or model.fit.sse < bound * bound * self.fits.model.size

    def _reached_from(self, begun: FittedModel, goes_on: bool) -> FittedModel:
        """Return the model that further proposals lead to, without what is not missed in the end.

        Args:
            begun: What a first round led to.
            goes_on: Whether that was worth it.
        """
        best = begun
        for _ in range(MOST_JOINT - 1 if goes_on else 0):
            if self._is_over() or self.comparisons.is_clean(best):
                break
            after = self._after_a_round(best)
            if after is best:
                break
            best = after
        pruned = self._jointly_pruned(self._reshaped(best))
        return self._beside_sensors(pruned) if self._goes_elsewhere(pruned) else self.extended(pruned)

    def _after_a_round(self, now: FittedModel) -> FittedModel:
        """Return the best fit of what is proposed beside a model, several candidates at once; itself where that is not worth it."""
        if self._is_over():
            return now
        self._report(f"weighing {len(self.proposals.candidates)} candidates together")
        proposals = joint_proposals(
            self.fits.model, now, self.proposals.candidates, self.fits.threads, self.fits.is_spent, self.fits.signature_sizes
        )
        fitted = [self._proposed(now, one) for one in proposals]
        richer = min(fitted, key=lambda one: one.fit.sse, default=now)
        if richer.fit.sse > (1.0 - WORTH_A_ROUND) * now.fit.sse:
            return now
        return self._on_from(richer, f"{len(richer.candidates)} together")

    def _beside_sensors(self, now: FittedModel) -> FittedModel:
        """Return a model with the fault of one sensor that explains the larger part of what is left, if one does.

        Faults of sensors are not proposed with the others. What is asked of another subsystem would be asked with what stands in for it.
        """
        if self.comparisons.is_clean(now) or self._is_over():
            return now
        faults = [c for c in self.proposals.candidates if c.kind is Kind.SENSOR and c.at not in now.named]
        looks = [self.fits.look((*now.candidates, one), now) for one in faults]
        if not looks:
            return now
        best = self.fits.fit(self.comparisons.ranked(looks)[0].candidates, now)
        fault = best.candidates[-1]
        if best.fit.sse > (1.0 - LARGER_PART) * now.fit.sse or not is_more_than_healthy(fault, best) or is_at_bound(fault, best):
            return now
        self._report(f"{fault.effect.replace('_', ' ')} of {fault.where} beside them")
        return self._jointly_pruned(self.fits.carried_on(best))

    def _reshaped(self, now: FittedModel) -> FittedModel:
        """Return a model with the effects that do not answer in proportion begun anew at their best shapes, where that leaves less.

        One whose fit leaves less without it is left out: at the shape where it is, it only keeps the others from what they are.
        """
        for candidate in [one for one in now.candidates if self.proposals.shapes_of(one)]:
            if self.comparisons.is_clean(now) or self._is_over():
                break
            if candidate not in now.candidates:
                continue
            without = self.fits.fit(drop_orphans(now.without(candidate)), now)
            if without.fit.sse < now.fit.sse:
                now = self._on_from(without, f"{candidate.effect.replace('_', ' ')} left out")
                continue
            begun = self.proposals.reshaped(candidate, now, without)
            again = now if begun is None else self.fits.fit(begun.candidates, begun, again=True)
            if self.comparisons.ranked([now, again])[0] is not now:
                now = self._on_from(again, f"{candidate.effect.replace('_', ' ')} begun anew")
        return now

    def _on_from(self, reached: FittedModel, words: str) -> FittedModel:
        """Return a model whose fit has gone on from where it was reached, and say so."""
        now = self.fits.carried_on(reached)
        self._report(f"{words}, {math.sqrt(now.fit.sse / self.fits.model.size):.1f} times the noise left")
        return now

    def _jointly_pruned(self, now: FittedModel) -> FittedModel:
        """Return a model without what is not missed beside the rest.

        That is known in closed form. Where a fit without it shows that it is missed (an optimum may lie at a kink), it stays.
        """
        while now.candidates and not self.fits.is_spent():
            kept = jointly_pruned(self.fits.model, now, self.fits.threads)
            if len(kept) == len(now.candidates):
                break
            fewer = self.fits.fit(kept, now)
            if self.comparisons.evidence(fewer, now).beside_discrepancy > acceptance.BESIDE_DISCREPANCY:
                break
            now = self.fits.carried_on(fewer)
            self._report(f"{len(now.candidates)} worth their parameters")
        return now

    def extended(self, now: FittedModel) -> FittedModel:
        """Return a model with what a whole fit finds beside it: an effect whose signature is not in proportion to its size is not
        proposed with the others.
        """
        for _ in range(MOST_EXTENSIONS):
            if self.comparisons.is_clean(now) or self._is_over():
                break
            asked = self.proposals.additions(now)
            self._report(f"{len(asked)} more to be fitted beside {len(now.candidates)}")
            looks = [self.fits.look((*now.candidates, one), now) for one in asked]
            close = self.comparisons.ranked(looks)[:FIRST_LOOKED] if looks else []
            models = self.fits.fit_all([(model.candidates, model) for model in close])
            models += self.fits.fit_all([(model.candidates, model) for model in self.proposals.shaped(now)], again=True)
            shown = [
                model for model in models
                if is_more_than_healthy(model.candidates[-1], model) and not is_at_bound(model.candidates[-1], model)
                and self.comparisons.evidence(now, model).beside_discrepancy > acceptance.BESIDE_DISCREPANCY
            ]  # fmt: skip
            if not shown:
                break
            now = self._jointly_pruned(self.fits.carried_on(self.comparisons.ranked(shown)[0]))
        return now

    def _proposed(self, now: FittedModel, proposal: Proposal) -> FittedModel:
        """Return the fit of a model with what is proposed beside it, less what leads astray where it stands: sizes add up only nearly."""
        model, added = self.fits.model, proposal.candidates

        def misfit(more: Sequence[Candidate]) -> float:
            values = {**now.fit.values, **{q: proposal.values[q] for one in more for q in one.parameters}}
            residual = model.residual(values, [pair for one in (*now.candidates, *more) for pair in one.fixed])
            return float(residual @ residual) if np.isfinite(residual).all() else math.inf

        here = misfit(added)
        while added and here > STRAY * now.fit.sse and not self.fits.is_spent():
            fewer = [drop_orphans(tuple(c for c in added if c is not one), now.bears) for one in added]
            tried = self.fits.threads.predictions(misfit, fewer)
            best = int(np.argmin(tried))
            here, added = tried[best], fewer[best]
        near = FittedModel(now.candidates, replace(now.fit, values={**now.fit.values, **proposal.values}))
        return self.fits.fit((*now.candidates, *added), near) if added else now
