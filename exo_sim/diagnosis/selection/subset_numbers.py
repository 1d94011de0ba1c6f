"""The numbers that a weighed subset gives its parameters: where a fit of it begins, and what its other laws would give instead."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.selection.laws import Law
from exo_sim.diagnosis.selection.linear_evidence import Posterior
from exo_sim.diagnosis.selection.subset_weighing import SubsetWeighing, Weighed


def values_and_errors(
    weighing: SubsetWeighing, nuisances: Sequence[FreeParameter], one: Weighed, posterior: Posterior
) -> tuple[dict[FreeParameter, float], dict[FreeParameter, float]]:
    """Return where the fit of a subset starts, and the posterior standard deviation of its effects' parameters.

    Args:
        weighing: Of the subsets.
        nuisances: All nuisance parameters of the subsystem; those that the family does not have stay where they start.
        one: The subset.
        posterior: Of the subset.
    """
    family = weighing.family
    values = {q: q.start for q in nuisances}
    for parameter, deviation in zip(family.nuisances, posterior.background, strict=True):
        assert parameter.prior is not None
        values[parameter] = parameter.prior[0] + parameter.prior[1] * float(deviation)
    errors: dict[FreeParameter, float] = {}
    first = 0
    for term in weighing.terms(one):
        sizes = posterior.sizes[first : first + term.columns.shape[1]]
        spread = posterior.errors[first : first + term.columns.shape[1]]
        first += term.columns.shape[1]
        before = dict(values)
        values |= term.parameters(sizes, before)
        for k in range(sizes.size):
            shifted = term.parameters(sizes + spread * (np.arange(sizes.size) == k), before)
            for parameter, value in shifted.items():
                errors[parameter] = math.hypot(errors.get(parameter, 0.0), value - values[parameter])
    values |= family.linearisations[one.point].values
    return {q: min(max(value, q.low), q.high) for q, value in values.items()}, errors


def laws_of(weighing: SubsetWeighing, nuisances: Sequence[FreeParameter], best: Weighed, finalists: Sequence[Weighed]) -> list[Law]:
    """Return every law that the effects of the best subset may follow, and may follow beside other effects, by how probable it is.

    Args:
        weighing, nuisances: As of `values_and_errors`.
        best: The subset.
        finalists: Those that were weighed to the end.
    """
    alike = weighing.alike(best, finalists)
    known, wanted = {(one.point, one.subset) for one in alike}, {c.at for c in weighing.candidates(best)}
    alike += [
        one for one in finalists
        if (one.point, one.subset) not in known and one.score > -math.inf and wanted & {c.at for c in weighing.candidates(one)}
    ]  # fmt: skip
    highest, found = max(one.score for one in alike), []
    for one in alike:
        weight = math.exp(one.score - highest)
        if weight >= verdicts.LEAST_LAW_WEIGHT:
            own = one.point == best.point and one.subset == best.subset
            present = frozenset(c.key for c in weighing.candidates(one) if not c.is_law)
            found.append(Law(weight, own, *values_and_errors(weighing, nuisances, one, weighing.posterior(one)), present))
    return found
