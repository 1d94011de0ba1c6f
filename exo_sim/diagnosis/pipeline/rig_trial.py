"""One improved rig on held-out time: in windows of each balance and of the whole machine, and run free from several measured states.

A run that nothing corrects strays by what its first state and the whole way since then happened to be: a piston that nothing holds ends
elsewhere by chance, with a good rig as with a poor one. Runs begun at several measured states say by how much such a result would differ.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import stdtrit

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.findings import SignalFit
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.policy.budgets import MOST_TRIALS
from exo_sim.diagnosis.policy.validation import (
    BETTER_BY_CHANCE,
    DIVERGED,
    FAR_BETTER,
    FEWEST_BLOCKS,
    FEWEST_STARTS,
    MOST_WORSE,
    SIGNAL_WORSE,
    STRAYS_BY_CHANCE,
    SURELY_BETTER,
)
from exo_sim.diagnosis.validation.machine_runs import Blocks, MachineRuns
from exo_sim.rig import Rig

Fits = Mapping[str, SignalFit]


@dataclass(frozen=True)
class Trial:
    """One improved rig on held-out time.

    Attributes:
        update: What is in it.
        windows, free_run: Its errors, by signal, beside those of the rig handed in: of each balance, and of the whole machine run free
            from the first measured state of the recordings.
        spreads: Standard deviations of the signals, as far as they are recorded.
        coupled: Errors of the whole machine over windows.
        uncertain: Standard error of the mean logarithm of the latter.
        starts: As `free_run`, of runs begun at measured states of held-out time, one for each, until the next one's.
        is_refused: Whether the rig cannot be read, or cannot be a machine.
        is_first: Whether it holds all that was found, with numbers as fitted by the balances, or together: of what is tried after these
            two some rig is better by chance sooner than any one.
    """

    update: RigUpdate
    windows: Fits
    free_run: Fits
    spreads: Mapping[str, float]
    coupled: Fits = field(default_factory=dict)
    uncertain: float = 0.0
    starts: tuple[Fits, ...] = ()
    is_refused: bool = False
    is_first: bool = True

    @property
    def is_worse(self) -> bool:
        """Whether it is worse than the rig handed in by any measure; over windows of the whole machine, unless it is surely better.

        These are many, so that they say how far another recording's would differ: what is better by less is hardly likelier to be better
        there than worse, and the rig handed in is its owner's. A free run that is far better says the same of the whole machine. One
        free run that is worse is by chance where runs from several measured states are surely better. Where nothing was found, no signal
        pays for another: numbers that are within their data sheets may stay as the owner knows them.
        """
        if self.is_refused or is_worse(self.windows, self.spreads) or (self.update.parts and self.hurts_for_no_finding):
            return True
        if is_worse(self.free_run, self.spreads) and not self.is_surely_better_begun_anew:
            return True
        if _mean(self._run_free()) > math.log1p(MOST_WORSE) or self.strays:
            return True
        far = _mean(_logs(self.free_run, self.spreads)) < math.log(FAR_BETTER)
        unsure = 0.0 if far else SURELY_BETTER * self.uncertain
        return _mean(_logs(self.coupled, self.spreads)) + unsure > math.log1p(MOST_WORSE)

    @property
    def strays(self) -> tuple[str, ...]:
        """Signals that free runs miss by surely more than with the rig handed in, whatever the others win."""
        return straying_further(self.starts)

    @property
    def hurts_for_no_finding(self) -> bool:
        """Whether nothing of it is a finding, and free runs miss some signal by more than a trifle, by the mean over all of them."""
        if self.update.holds_findings:
            return False
        runs = (self.free_run, *self.starts)
        return any(_mean(_paired(runs, column)) > math.log1p(SIGNAL_WORSE) for column in self.free_run)

    @property
    def is_surely_better_begun_anew(self) -> bool:
        """Whether runs from several measured states are surely better, over their signals together."""
        return _surely_better([_mean(own) for own in (_logs(fits, self.spreads) for fits in self.starts) if own], self._doubt)

    @property
    def _doubt(self) -> float:
        """Probability with which it may be called surely better where it is equally good."""
        return 0.5 * BETTER_BY_CHANCE / (2 if self.is_first else MOST_TRIALS - 1)

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
        return sum(map(_mean, (_logs(self.windows, self.spreads), self._run_free(), _logs(self.coupled, self.spreads))))

    @property
    def loss_of_machine(self) -> float:
        """The same of the whole machine alone: a balance by itself always prefers the numbers that were fitted to it by itself."""
        if self.is_refused:
            return math.inf
        return _mean(self._run_free()) + _mean(_logs(self.coupled, self.spreads))

    def by_chance(self) -> dict[str, tuple[float, int]]:
        """Return which signals one run from the first measured state misses by more than with the rig handed in, and runs from several
        states surely by less: by column, the ratio of the latter's errors, and how many runs these are.
        """
        logs = {column: _paired(self.starts, column) for column in self.free_run}
        asked = sum(len(own) >= FEWEST_STARTS for own in logs.values())
        return {
            column: (math.exp(_mean(logs[column])), len(logs[column]))
            for column, fit in self.free_run.items()
            if fit.after > (1.0 + SIGNAL_WORSE) * fit.before and _surely_better(logs[column], self._doubt / max(asked, 1))
        }

    def _run_free(self) -> list[float]:
        return [log for fits in (self.free_run, *self.starts) for log in _logs(fits, self.spreads)]


def gain(runs: MachineRuns, rig: Rig, data: MachineData) -> tuple[float, float]:
    """Return by how much the mean logarithm of the whole machine's errors falls with a rig, and its standard error; 0 where nothing runs.

    Args:
        runs: Over windows, of the rig that it is held against.
        rig: The rig.
        data: The recordings.
    """
    errors = runs.errors(rig)
    logs = _logs(errors, {column: spread_of(data, column) for column in errors})
    return -_mean(logs), uncertainty(runs.by_block(rig), {column: fit.noise for column, fit in errors.items()})


def straying_further(runs: Sequence[Fits]) -> tuple[str, ...]:
    """Return the signals whose errors are larger by surely more than a trifle, by the mean logarithm over runs and its standard error.

    The latter is that of few runs: Student's distribution says how many of them are sure, and the more signals are asked the surer each
    of them has to be. A run that diverges alone is a larger error.

    Unlike in `is_worse`, a signal counts that neither rig predicts better than its own mean: a piston that stands at the wrong end all the
    time is missed by more than one that merely lags.

    Args:
        runs: Errors by signal, of runs begun at different measured states, none over the time of another.
    """
    every = {column: _paired(runs, column) for column in dict.fromkeys(column for fits in runs for column in fits)}
    asked = {column: logs for column, logs in every.items() if len(logs) >= FEWEST_STARTS}
    return tuple(
        column
        for column, logs in asked.items()
        if max(logs) >= DIVERGED or _mean(logs) - _reach(logs, STRAYS_BY_CHANCE / len(asked)) > math.log1p(SIGNAL_WORSE)
    )


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
    return [
        log
        for column, fit in runs.items()
        if not math.isfinite(fit.after) or min(fit.before, fit.after) <= spreads.get(column, math.inf)
        for log in _paired((runs,), column)
    ]


def _paired(runs: Sequence[Fits], column: str) -> list[float]:
    """Return, of every run that predicts a signal with the rig handed in, the logarithm of the error after over that before."""
    logs = []
    for fit in (fits[column] for fits in runs if column in fits):
        if math.isfinite(fit.before) and fit.before > 0.0:
            floor = max(fit.noise, 1e-300)
            logs.append(math.log(max(fit.after, floor) / max(fit.before, floor)) if math.isfinite(fit.after) else float(DIVERGED))
    return logs


def _surely_better(logs: Sequence[float], doubt: float) -> bool:
    """Return whether the mean of a few runs' logarithms is below nil, with so much doubt left."""
    return len(logs) >= FEWEST_STARTS and _mean(logs) + _reach(logs, doubt) < 0.0


def _reach(logs: Sequence[float], doubt: float) -> float:
    """Return how far the mean of few runs may be off with so much doubt left, to one side, by Student's distribution; of two at least."""
    return float(stdtrit(len(logs) - 1, 1.0 - doubt)) * float(np.std(logs, ddof=1)) / math.sqrt(len(logs))


def _mean(logs: Sequence[float]) -> float:
    return sum(logs) / len(logs) if logs else 0.0
