"""Whether the commands of a slow recording are what its valves were told, or samples of a loop that is quicker than the logger."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from exo_sim.diagnosis.data.sampled_commands import may_be_sampled
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.least_squares import fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Values
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.subsystems.gas.model import GasModel


def read_as_sampled(
    model: GasModel, split: Split, start: Values, fixed: Sequence[tuple[FreeParameter, float]], most: float, unexplained: bool = False,
    threads: Threads = SERIAL, is_spent: IsSpent = never,
) -> GasModel:
    """Return the model with commands read as samples, where these numbers, fitted again, then leave plainly less; else the model itself.

    Args:
        model: Under commands that are held.
        split: Which time may be used.
        start: What is free, and where it begins.
        fixed: What is not.
        most: Share of the squared error that commands which are samples leave at most.
        unexplained: Whether held commands leave more than noise: then it may be what happened between samples, and commands are read as
            samples as well where that is likelier.
        threads: Threads.
        is_spent: Whether the time is up.
    """
    if not any(may_be_sampled(run) and not run.sampled for run in model.all_runs):
        return model
    sampled = GasModel([replace(run, sampled=may_be_sampled(run)) for run in model.all_runs], model.nominal, split)
    left, misfit = [], []
    for one in (model, sampled):
        residual = partial(one.residual, fixed=fixed)
        found = fit(residual, tuple(start), start, threads, max_iterations=4, is_spent=is_spent)
        errors = one.errors(one.apply(found.values, fixed))
        left.append(float(np.sum(model.as_rows(errors) ** 2)))  # both held against the same noise
        misfit.append(found.sse + one.log_variance)
    return sampled if left[1] < most * left[0] or (unexplained and misfit[1] < misfit[0]) else model
