"""A model fits no worse than those that are nested in it: where one of them leaves less, the fit ended elsewhere."""

from __future__ import annotations

from collections.abc import Callable

from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.policy import verdicts
from exo_sim.diagnosis.policy.budgets import MOST_BEGUN_FROM_NESTED
from exo_sim.diagnosis.selection.fitted_model import FittedModel

#: Fits candidates, begun near another model; with `again` also where they were fitted before, the better fit kept.
Fitting = Callable[[tuple[Candidate, ...], FittedModel, bool], FittedModel]


def no_worse_than_nested(model: FittedModel, fit: Fitting, deficit: Callable[[FittedModel, FittedModel], float]) -> FittedModel:
    """Return a model, fitted again from one with an effect less where such a one is plainly more likely.

    That effect's numbers begin as they were, or as they usually do: the better fit is kept.

    Args:
        model: The model.
        fit: Fits candidates.
        deficit: By how much one model's log-likelihood is lower than another's, priors included.
    """
    for _ in range(MOST_BEGUN_FROM_NESTED):
        nested = [fit(drop_orphans(model.without(c)), model, False) for c in model.candidates]
        better = [one for one in nested if deficit(model, one) > verdicts.AS_GOOD]
        if not better:
            return model
        best = max(better, key=lambda one: deficit(model, one))
        begun = (FittedModel.at({**model.fit.values, **best.fit.values}), best)
        found = min((fit(model.candidates, near, True) for near in begun), key=lambda one: deficit(one, model))
        if deficit(model, found) <= 0.0:
            return model
        model = found
    return model
