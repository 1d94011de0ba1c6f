"""Effects that data would not have shown, had they been there at a size that is often met: not found is then not absent."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from exo_sim.diagnosis.estimation.candidate import Candidate
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.outcome.experiments import expected_gain, shifted
from exo_sim.diagnosis.policy.acceptance import LEAST_ODDS
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel


def unseen_effects(result: SubsystemResult[SubsystemModel], asked: Sequence[Candidate]) -> tuple[str, ...]:
    """Return the names of effects of which no form, where its fit begins (a quarter of the way into what is typical), would be accepted.

    The predictions with it and without differ by d, of which the fitted numbers of the model take what they can within their standard
    errors; what is left gives the odds that are to be expected, divided by the time over which errors are correlated.

    Args:
        result: Of the subsystem.
        asked: Candidates; laws, sensors and what needs another effect are passed over.
    """
    model, final = result.model, result.final
    errors = [(q, one) for q, one in result.fits.standard_errors(final).items() if math.isfinite(one) and one > 0.0]
    own = model.residual_of(result.plant_of(final))
    moved = [model.residual_of(shifted(result, final, q, one)) for q, one in errors]
    correlated = max(correlation_time(own, model.blocks), 1.0)
    shown: dict[str, bool] = {}
    for one in asked:
        if one.is_law or one.prerequisite or one.kind is not Kind.MISSING_PHYSICS or not one.starts:
            continue
        begun = dict(zip(one.parameters, one.starts[0], strict=True))
        values = {**one.beside({**final.fit.values, **begun}), **begun}
        acts = model.residual_of(model.apply(values, (*final.fixed, *one.fixed)))
        gain = expected_gain(np.stack([own, acts, *moved])) / correlated
        shown[one.effect] = shown.get(one.effect, False) or gain > LEAST_ODDS
    return tuple(name for name, is_shown in shown.items() if not is_shown)
