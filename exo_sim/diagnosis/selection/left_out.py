"""A model without one of its effects: as it is where the machine has no more of that than a healthy one."""

from __future__ import annotations

from typing import NamedTuple

from exo_sim.diagnosis.estimation.candidate import Candidate, drop_orphans
from exo_sim.diagnosis.selection.fitted_model import FittedModel, as_in_a_healthy_machine, remains
from exo_sim.diagnosis.selection.model_fits import ModelFits


class LeftOut(NamedTuple):
    """A model that an effect was left out of, fitted anew.

    Attributes:
        model: The model.
        is_gone: Whether nothing of the effect is left in it but what a healthy machine has by itself; else it is held to that.
    """

    model: FittedModel
    is_gone: bool


def left_out(candidate: Candidate, model: FittedModel, fits: ModelFits) -> LeftOut:
    """Return a model without a candidate, and what comes on top of it.

    A lag and a delay that healthy valves may each have may together be more than a healthy valve's, and stand in for what was left out:
    then they are held to what that has.

    Args:
        candidate: One of the model's.
        model: Fitted.
        fits: Fits of its subsystem.
    """
    without = fits.fit(drop_orphans(model.without(candidate)), model)
    if not remains(candidate, without):
        return LeftOut(without, True)
    return LeftOut(fits.fit_holding(without, as_in_a_healthy_machine(candidate, without)), False)
