"""The improved rig as far as it wins over the validation time: in windows of each balance and of the whole machine, and run free.

Numbers that were fitted to a gas under its recorded motion, and to forces under recorded pressures, may be worse where both are predicted:
a piston that sticks by other friction compresses its gas elsewhere. Whoever uses the rig runs the whole machine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.pipeline.rig_errors import WindowErrors
from exo_sim.diagnosis.policy.budgets import MOST_TRIALS
from exo_sim.diagnosis.policy.validation import (
    DIVERGED,
    FAR_BETTER,
    FEWEST_BLOCKS,
    MOST_WORSE,
    SIGNAL_WORSE,
    SURELY_BETTER,
    WORTH_LEAVING_OUT,
)
from exo_sim.diagnosis.validation.machine_runs import Blocks, MachineRuns
from exo_sim.errors import ModelError, RigError
from exo_sim.rig import parse
from exo_sim.simulation.replay import WINDOW

Fits = Mapping[str, SignalFit]

_CUT = "improved.toml leaves out what predicts time kept back worse: {}"
_REFUSED = "improved.toml holds less than what was found: a rig with all of it is refused, {}"
_UNPROVED = "improved.toml was not put to the test: nothing of the time kept back can be predicted, or the recordings are too long"


@dataclass(frozen=True)
class Trial:
    """One improved rig on the held-out time.

    Attributes:
        update: What is in it.
        windows, free_run: Its errors, by signal, beside those of the rig handed in: of each balance, and of the whole machine run free.
        spreads: Standard deviations of the signals, as far as they are recorded.
        coupled: Errors of the whole machine over windows.
        uncertain: Standard error of the mean logarithm of the latter.
        is_refused: Whether the rig cannot be read, or cannot be a machine.
    """

    update: RigUpdate
    windows: Fits
    free_run: Fits
    spreads: Mapping[str, float]
    coupled: Fits = field(default_factory=dict)
    uncertain: float = 0.0
    is_refused: bool = False

    @property
    def is_worse(self) -> bool:
        """Whether it is worse than the rig handed in by any measure; over windows of the whole machine, unless it is surely better.

        These are many, so that they say how far another recording's would differ: what is better by less is hardly likelier to be better
        there than worse, and the rig handed in is its owner's. A free run that is far better says the same of the whole machine.
        """
        if self.is_refused or is_worse(self.windows, self.spreads) or is_worse(self.free_run, self.spreads):
            return True
        far = _mean(_logs(self.free_run, self.spreads)) < math.log(FAR_BETTER)
        unsure = 0.0 if far else SURELY_BETTER * self.uncertain
        return _mean(_logs(self.coupled, self.spreads)) + unsure > math.log1p(MOST_WORSE)

    @property
    def hurts(self) -> bool:
        """Whether any signal got worse by more than a trifle."""
        logs = (log for fits in (self.windows, self.free_run, self.coupled) for log in _logs(fits, self.spreads))
        return max(logs, default=0.0) > math.log1p(SIGNAL_WORSE)

    @property
    def is_proved(self) -> bool:
        """Whether anything could be predicted with it at all."""
        return bool(self.windows or self.free_run or self.coupled)

    @property
    def loss(self) -> float:
        """Mean logarithm of the errors over those of the rig handed in, all measures counted alike."""
        if self.is_refused:
            return math.inf
        return sum(_mean(_logs(fits, self.spreads)) for fits in (self.windows, self.free_run, self.coupled))


def accepted(
    data: MachineData, update: RigUpdate, split: Split, is_spent: IsSpent = never
) -> tuple[Trial, tuple[str, ...]]:
    """Return as much of an update as wins, with its errors, and remarks: that something was left out, or that nothing could be tried.

    Args:
        data: The recordings, and the rig as handed in.
        update: What was found.
        split: What wins over its validation time is taken, or over the test time where there is no other; errors are of the test time.
        is_spent: Whether the time is up: then it is all of the update, or nothing.
    """
    refusals: list[str] = []
    choosing = split.validation_as_test() if split.validation else split
    windows, free, whole = WindowErrors(data, choosing), MachineRuns(data, choosing), MachineRuns(data, choosing, WINDOW)

    def tried(one: RigUpdate) -> Trial:
        try:
            rig = parse(one.text(data.rig.path.parent), data.rig.path)
            inside, run, coupled = windows.errors(rig), free.errors(rig), whole.errors(rig)
        except (RigError, ModelError) as refusal:
            refusals.append(str(refusal))
            return Trial(one, {}, {}, {}, is_refused=True)
        spreads = {column: spread_of(data, column) for column in {*inside, *run, *coupled}}
        floors = {column: fit.noise for column, fit in coupled.items()}
        return Trial(one, inside, run, spreads, coupled, uncertainty(whole.by_block(rig), floors))

    best = as_far_as_it_wins(update, tried, is_spent)
    is_cut, is_unproved = best.update is not update and not refusals, bool(best.update.parts) and not best.is_proved
    said = ((_CUT.format(update.without(best.update)), is_cut), (_UNPROVED, is_unproved))
    if choosing is not split:
        rig = parse(best.update.text(data.rig.path.parent), data.rig.path)
        best = replace(best, windows=WindowErrors(data, split).errors(rig), free_run=free.over(split).errors(rig))
    return best, (*(_REFUSED.format(why) for why in refusals[:1]), *(words for words, is_so in said if is_so))


def as_far_as_it_wins(update: RigUpdate, tried: Callable[[RigUpdate], Trial], is_spent: IsSpent = never) -> Trial:
    """Return the trial of as much of an update as is not worse by either measure.

    Where it is worse, or a signal got worse, what one source gives is left out rank by rank, always what helps most; nothing that wins
    is left out for the sake of a signal that another source hurts. Where that ends with nothing, for several parts must go before any of
    it wins, it is the best of what was found alone, by all sources or by one.

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
            break
        if not best.is_worse and (next_best.is_worse or next_best.loss > best.loss - WORTH_LEAVING_OUT):
            break
        best = next_best
    if not best.is_worse and (best.update.parts or not update.parts):
        return best
    alone = [] if is_spent() else [trial for trial in map(tried, update.found_alone()) if not trial.is_worse]
    if alone:
        return min(alone, key=lambda one: one.loss)
    return tried(RigUpdate(update.rig, ())) if best.update.parts else best


def spread_of(data: MachineData, column: str) -> float:
    """Return the standard deviation of a signal over all recordings that have it, in its unit; infinite where none has."""
    parts = [table[column] for table in data.recordings if column in table.columns]
    return float(np.nanstd(np.concatenate(parts))) if parts else math.inf


def uncertainty(blocks: Mapping[str, Blocks], floors: Mapping[str, float]) -> float:
    """Return the standard error of the mean logarithm of errors after over before, by leaving out one block of time after the other.

    Args:
        blocks: By signal, the squared errors of its blocks.
        floors: By signal, the noise: an error below it is none.
    """
    numbers = sorted({number for one in blocks.values() for number in one})
    if len(numbers) < FEWEST_BLOCKS:
        return 0.0
    total = np.zeros(len(numbers))
    counted = 0
    for signal, own in blocks.items():
        table = np.array([own.get(number, np.zeros(3)) for number in numbers])
        left = table.sum(axis=0) - table
        if not np.isfinite(left).all() or (left[:, 0] <= 0.0).any():
            continue
        means = np.maximum(left[:, 1:] / left[:, :1], max(floors.get(signal, 0.0), 1e-300) ** 2)
        total += 0.5 * np.log(means[:, 1] / means[:, 0])
        counted += 1
    n = len(numbers)
    return float(np.sqrt((n - 1) / n * np.sum((total - total.mean()) ** 2))) / counted if counted else 0.0


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
                floor = max(fit.noise, 1e-300)
                logs.append(math.log(max(fit.after, floor) / max(fit.before, floor)))
    return logs


def _mean(logs: list[float]) -> float:
    return sum(logs) / len(logs) if logs else 0.0
