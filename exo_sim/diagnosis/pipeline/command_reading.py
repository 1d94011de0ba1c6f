"""Whether the commands of a slow recording are what its valves received, or samples of a loop that is quicker than the logger."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.sampled_commands import may_be_sampled
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.estimation.least_squares import Derivatives, fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Values
from exo_sim.diagnosis.estimation.threads import SERIAL, Threads
from exo_sim.diagnosis.policy.acceptance import LEAST_ODDS
from exo_sim.diagnosis.policy.budgets import MOST_STEPS
from exo_sim.diagnosis.subsystems.gas.model import GasModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Left:
    """What one reading of the commands leaves in each row, shape (m,).

    Attributes:
        errors: In units of the noise under held commands.
        residual: In units of what that reading leaves unknown.
        log_variance: Logarithm of the variance that it expects [Pa^2].
        blocks: Block of time.
    """

    errors: Array
    residual: Array
    log_variance: Array
    blocks: NDArray[np.int64]

    def of(self, rows: NDArray[np.bool_]) -> _Left:
        """Return it of some rows."""
        return _Left(self.errors[rows], self.residual[rows], self.log_variance[rows], self.blocks[rows])

    @property
    def square(self) -> float:
        """The squared error."""
        return float(self.errors @ self.errors)

    @property
    def log_likelihood(self) -> float:
        """Of a row, at the level of the errors that suits it best: errors of a model that lacks something are no evidence of a reading."""
        return -0.5 * (math.log(max(float(np.mean(self.residual**2)), 1e-300)) + float(np.mean(self.log_variance)))

    @property
    def independent(self) -> float:
        """The number of rows that are independent."""
        return self.residual.size / correlation_time(self.residual, self.blocks)


def as_sampled(model: GasModel, split: Split, recordings: Collection[str]) -> GasModel:
    """Return the model with the commands of some recordings read as samples; itself where none of them may be.

    What the two predict is counted together.

    Args:
        model: The gas.
        split: Which time may be used.
        recordings: Their names.
    """
    turned = [replace(run, sampled=run.sampled or (run.recording in recordings and may_be_sampled(run))) for run in model.all_runs]
    changed = any(one.sampled is not run.sampled for one, run in zip(turned, model.all_runs, strict=True))
    return GasModel(turned, model.nominal, split, effort=model.effort) if changed else model


def read_as_sampled(
    model: GasModel, split: Split, start: Values, fixed: Sequence[tuple[FreeParameter, float]], most: float, unexplained: bool = False,
    threads: Threads = SERIAL, is_spent: IsSpent = never, near: Mapping[FreeParameter, Array] = MappingProxyType({}),
) -> GasModel:
    """Return the model with commands read as samples in those recordings that are predicted better so; itself where none is.

    Args:
        model: Under commands that are held.
        split: Which time may be used.
        start: What is free, and where it begins: both readings are fitted from there.
        fixed: What is not.
        most: Share of the squared error that commands which are samples leave at most.
        unexplained: Whether held commands leave more than noise: then it may be what happened between samples, and commands are read as
            samples as well where they leave less at all and are plainly likelier.
        threads: Threads.
        is_spent: Whether the time is up.
        near: Columns of the Jacobian about where they begin, by parameter.
    """
    slow = {run.recording for run in model.all_runs if may_be_sampled(run) and not run.sampled}
    if not slow:
        return model
    left = []
    for one in (model, as_sampled(model, split, slow)):
        found = fit(
            partial(one.residual, fixed=fixed), tuple(start), start, threads,
            max_iterations=MOST_STEPS, derivatives=Derivatives(near), is_spent=is_spent,
        )  # fmt: skip
        errors = one.errors(one.apply(found.values, fixed))
        left.append(_Left(model.as_rows(errors), one.as_rows(errors), 2.0 * np.log(one.scale), one.blocks))
    recordings = model.recordings
    held, sampled = ({name: one.of(recordings == name) for name in slow} for one in left)
    return as_sampled(model, split, [name for name in slow if _is_better(sampled[name], held[name], most, unexplained)])


def _is_better(sampled: _Left, held: _Left, most: float, unexplained: bool) -> bool:
    """Return whether commands read as samples explain a recording better; the last two as of `read_as_sampled`."""
    if not held.errors.size:
        return False
    if sampled.square < most * held.square:
        return True
    gained = min(held.independent, sampled.independent) * (sampled.log_likelihood - held.log_likelihood)
    return unexplained and sampled.square < held.square and gained > LEAST_ODDS * math.log(10.0)
