"""The most probable subsets of a linear family held against each other by fits of what they name, where the weighing is not enough.

Subsets are weighed along lines, over a grid of shapes, and what they share is named. Where two of them explain the recording with other
names each (drag, or a dip and viscous friction), neither's may be probable enough, and what they share leaves what no healthy machine
does. Fitted as they act one of them may leave nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.budgets import MOST_REFITTED
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SetKey, key_of
from exo_sim.diagnosis.selection.marginal_fit import MarginalFits
from exo_sim.diagnosis.selection.simpler_forms import poorer_than
from exo_sim.diagnosis.selection.subset_weighing import Weighed


@dataclass(frozen=True)
class Refitted:
    """A subset whose names were fitted.

    Attributes:
        weighed: The subset.
        beside: Fits beside the discrepancy that this subset leaves.
        model: The fit, without what it left nothing of.
        names_suffice: The subset holds something without a name as well, of which the names, fitted as they act, leave no more than a
            healthy machine has.
    """

    weighed: Weighed
    beside: MarginalFits
    model: FittedModel
    names_suffice: bool = False


def poorer_forms_first(finalists: Sequence[Weighed], names: Callable[[Weighed], tuple[Candidate, ...]]) -> list[Weighed]:
    """Return subsets, behind the most probable one that which has the same effects in poorer forms, the others in their order.

    A richer form takes up what lines leave of the shapes of the others; fitted as they act the poorer one may leave less.

    Args:
        finalists: The subsets, the most probable first.
        names: What a subset names.
    """
    best, *rest = finalists
    effects = {c.effect for c in names(best)}

    def is_poorer(one: Weighed) -> bool:
        own = {c.effect for c in names(one)}
        gone, new = effects - own, own - effects
        return bool(gone) and len(own) == len(effects) and all(any(name in poorer_than(richer) for richer in gone) for name in new)

    first = next((one for one in rest if is_poorer(one)), None)
    return list(finalists) if first is None else [best, first, *(one for one in rest if one is not first)]


def best_refitted(
    first: Refitted, finalists: Sequence[Weighed], names: Callable[[Weighed], tuple[Candidate, ...]],
    refit: Callable[[Weighed, tuple[Candidate, ...]], Refitted], evidence: Callable[[FittedModel], float],
) -> Refitted:  # fmt: skip
    """Return the subset with the greatest evidence where what it names is fitted; the first, unless another surpasses it plainly.

    Args:
        first: What was chosen by the weighing.
        finalists: The subsets, the most probable first.
        names: What a subset names.
        refit: Fits a subset's names.
        evidence: The logarithm of a fitted model's evidence, parameters paid for and names as common as they are.
    """
    return _surpassing(first, _each_set_once(finalists, names, key_of(first.model.candidates))[:MOST_REFITTED], refit, evidence)


def best_form(
    first: Refitted, alike: Sequence[Weighed], names: Callable[[Weighed], tuple[Candidate, ...]],
    refit: Callable[[Weighed, tuple[Candidate, ...]], Refitted], evidence: Callable[[FittedModel], float],
) -> Refitted:  # fmt: skip
    """Return the effects of the first subset fitted in each of their forms, the fit with the greatest evidence; the first, unless another
    surpasses it plainly.

    Lines are formed at a few values of how soon a contact slides, and beside a discrepancy that takes up what these leave. A form with a
    shape of its own takes that up as well: its fit may end where one power of speed does what dry friction, its dip and a film do.

    Args:
        first: As it was fitted.
        alike: Subsets with the same effects, the most probable first: the fit of a form begins at the most probable one that has it.
        names, refit, evidence: As of `best_refitted`.
    """
    return _surpassing(first, _each_set_once(alike, names, key_of(names(first.weighed))), refit, evidence)


def _each_set_once(
    subsets: Sequence[Weighed], names: Callable[[Weighed], tuple[Candidate, ...]], fitted: SetKey
) -> list[tuple[Weighed, tuple[Candidate, ...]]]:
    """Return subsets with what they name, of each set of names the first one, and none of the set that was fitted already."""
    found: dict[SetKey, tuple[Weighed, tuple[Candidate, ...]]] = {}
    for one in subsets:
        candidates = names(one)
        found.setdefault(key_of(candidates), (one, candidates))
    return [pair for key, pair in found.items() if key != fitted]


def _surpassing(
    first: Refitted, asked: Sequence[tuple[Weighed, tuple[Candidate, ...]]],
    refit: Callable[[Weighed, tuple[Candidate, ...]], Refitted], evidence: Callable[[FittedModel], float],
) -> Refitted:  # fmt: skip
    """Return the fit with the greatest evidence; the first, unless another surpasses it plainly."""
    best, most = first, evidence(first.model)
    for one, candidates in asked:
        rival = refit(one, candidates)
        found = evidence(rival.model)
        if found > most + verdicts.AS_GOOD:
            best, most = rival, found
    return best


def probability_of(gain: float) -> float:
    """Return the probability of a name whose model has this logarithm of evidence more than that without it."""
    return 1.0 / (1.0 + math.exp(-min(max(gain, -700.0), 700.0)))
