"""Which findings of a gas are needed beside the curve of what has no name.

A leak that opens with pressure is none of the list, and several that are each stand in for a part of it. Where a curve over one signal does
what they do, they are not there.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.policy.acceptance import STEADY_GAIN
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.held_out_gain import gain_in_errors
from exo_sim.diagnosis.subsystem_model import SubsystemModel

Array = NDArray[np.float64]


def needed_beside_curve(
    model: SubsystemModel, kept_back: SubsystemModel, fit: Callable[[tuple[Candidate, ...]], FittedModel], fitted: FittedModel,
    named: tuple[Candidate, ...],
) -> tuple[FittedModel, tuple[Candidate, ...]]:
    """Return the findings without which validation time is predicted worse, block for block, and the model with them.

    What is left of every model is given the curve over the one signal that it follows best, if it follows any. The one that is needed
    least goes first. Where the curve follows nothing, all of them stay.

    Args:
        model: The subsystem.
        kept_back: The same over validation time.
        fit: Fits the model with nothing but some findings.
        fitted: The model with all of them.
        named: The findings.
    """

    def left(one: FittedModel) -> tuple[Array, bool]:
        plant = model.apply(one.fit.values, one.fixed)
        missing = model.main_discrepancy(plant)
        return kept_back.residual_of(model.with_unknown(plant, missing)), missing.best is not None

    beside = left(fitted)[0]
    while named:
        trials = []
        for c in named:
            without = fit(drop_orphans([one for one in named if one is not c]))
            residual, follows = left(without)
            if follows and np.isfinite(residual).all():
                trials.append((gain_in_errors(kept_back, residual, beside), residual, without))
        gain, residual, without = min(trials, key=lambda trial: trial[0], default=(np.inf, beside, fitted))
        if gain > STEADY_GAIN:
            break
        beside, fitted = residual, without
        named = tuple(c for c in named if c in without.candidates)
    return fitted, named
