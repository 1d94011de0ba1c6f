"""The improved rig as far as it wins: over the held-out time it may not be worse than the rig handed in, in windows or run free."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.pipeline.rig_errors import WindowErrors
from exo_sim.diagnosis.policy.budgets import MOST_TRIALS
from exo_sim.diagnosis.policy.validation import DIVERGED, MOST_WORSE, SIGNAL_WORSE, WORTH_LEAVING_OUT
from exo_sim.diagnosis.validation.free_run import FreeRuns

Fits = Mapping[str, SignalFit]


@dataclass(frozen=True)
class Trial:
    """One improved rig on the held-out time.

    Attributes:
        update: What is in it.
        windows, free_run: Its errors, by signal, beside those of the rig handed in.
        spreads: Standard deviations of the signals, as far as they are recorded.
    """

    update: RigUpdate
    windows: Fits
    free_run: Fits
    spreads: Mapping[str, float]

    @property
    def is_worse(self) -> bool:
        """Whether it is worse than the rig handed in, by either measure."""
        return is_worse(self.windows, self.spreads) or is_worse(self.free_run, self.spreads)

    @property
    def hurts(self) -> bool:
        """Whether any signal got worse by more than a trifle."""
        logs = (*_logs(self.windows, self.spreads), *_logs(self.free_run, self.spreads))
        return max(logs, default=0.0) > math.log1p(SIGNAL_WORSE)

    @property
    def loss(self) -> float:
        """Mean logarithm of the errors over those of the rig handed in, both measures counted alike."""
        return _mean(_logs(self.windows, self.spreads)) + _mean(_logs(self.free_run, self.spreads))


def accepted(
    data: MachineData, update: RigUpdate, folder: Path, split: Split, is_spent: IsSpent = never
) -> tuple[Trial, bool]:
    """Return as much of an update as wins, with its errors, and whether something of it was left out.

    Args:
        data: The recordings, and the rig as handed in.
        update: What was found.
        folder: Of the rig as handed in.
        split: Its test time counts.
        is_spent: Whether the time is up: then it is all of the update, or nothing.
    """
    windows, free = WindowErrors(data, split), FreeRuns(data, split)

    def tried(one: RigUpdate) -> Trial:
        text = one.text(folder)
        inside, run = windows.errors(text), free.errors(text)
        return Trial(one, inside, run, {column: spread_of(data, column) for column in {*inside, *run}})

    best = as_far_as_it_wins(update, tried, is_spent)
    return best, best.update is not update


def as_far_as_it_wins(update: RigUpdate, tried: Callable[[RigUpdate], Trial], is_spent: IsSpent = never) -> Trial:
    """Return the trial of as much of an update as is not worse by either measure.

    Where it is worse, or a signal got worse, what one source gives is left out rank by rank, always what helps most; nothing that wins
    is left out for the sake of a signal that another source hurts.

    Args:
        update: All that was found.
        tried: Puts an update to the test.
        is_spent: As of `accepted`.
    """
    best, trials = tried(update), 1
    while best.update.parts and (best.is_worse or best.hurts):
        fewer = [tried(one) for one in best.update.reduced()] if trials < MOST_TRIALS and not is_spent() else []
        trials += len(fewer)
        next_best = min(fewer, key=lambda one: (one.is_worse, one.loss), default=None)
        if next_best is None:
            best = tried(RigUpdate(update.rig, ())) if best.is_worse else best
            break
        if not best.is_worse and (next_best.is_worse or next_best.loss > best.loss - WORTH_LEAVING_OUT):
            break
        best = next_best
    return best


def spread_of(data: MachineData, column: str) -> float:
    """Return the standard deviation of a signal over all recordings that have it, in its unit; infinite where none has."""
    parts = [table[column] for table in data.recordings if column in table.columns]
    return float(np.nanstd(np.concatenate(parts))) if parts else math.inf


def is_worse(runs: Fits, spreads: Mapping[str, float]) -> bool:
    """Return whether errors rose, over the signals together; also where a run with the update diverges.

    A signal that neither run predicts better than its own mean would say nothing: a piston that slides wherever a tenth of a newton
    lets it is nowhere near either way.

    Args:
        runs: Errors by signal.
        spreads: Standard deviations of the signals.
    """
    return _mean(_logs(runs, spreads)) > math.log1p(MOST_WORSE)


def _logs(runs: Fits, spreads: Mapping[str, float]) -> list[float]:
    """Return the logarithm of the error after over that before, for every signal that says something."""
    logs = []
    for column, fit in runs.items():
        if math.isfinite(fit.before) and fit.before > 0.0:
            if not math.isfinite(fit.after):
                logs.append(float(DIVERGED))
            elif min(fit.before, fit.after) <= spreads.get(column, math.inf):
                logs.append(math.log(max(fit.after, 1e-300) / fit.before))
    return logs


def _mean(logs: list[float]) -> float:
    return sum(logs) / len(logs) if logs else 0.0
