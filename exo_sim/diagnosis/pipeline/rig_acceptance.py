"""The improved rig as far as it wins over the held-out time.

Numbers that were fitted to a gas under its recorded motion, and to forces under recorded pressures, may be worse where both are predicted:
a piston that sticks by other friction compresses its gas elsewhere. Whoever uses the rig runs the whole machine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.estimation.budget import IsSpent, never
from exo_sim.diagnosis.outcome.rig_update import RigUpdate
from exo_sim.diagnosis.pipeline.rig_errors import WindowErrors
from exo_sim.diagnosis.pipeline.rig_trial import Trial, spread_of, uncertainty
from exo_sim.diagnosis.policy.budgets import MOST_TRIALS
from exo_sim.diagnosis.policy.validation import STARTS, WORTH_LEAVING_OUT
from exo_sim.diagnosis.validation.machine_runs import MachineRuns
from exo_sim.errors import ModelError, RigError
from exo_sim.rig import Rig, parse
from exo_sim.simulation.replay import WINDOW

_CUT = "improved.toml leaves out what predicts held-out time worse: {}"
_UNSAYABLE = "improved.toml leaves out {}: {} is a joint and a cylinder, and the rig holds there what the cylinder has; rename either"
_REFUSED = "improved.toml holds less than what was found: a rig with all of it is refused, {}"
_UNPROVED = "improved.toml was not put to the test: nothing of the held-out time can be predicted, or the recordings are too long"
_BY_ALL = "improved.toml was cut down by all of the held-out time, for part of that was predicted worse: its errors there are no test"
_BY_CHANCE = (
    "{} strays further with improved.toml in the one run from the beginning, by chance: in runs from {} measured states of held-out "
    "time it is missed by {:.2g} of the error of the rig handed in"
)


class Judge:
    """Puts updates of a rig to the test.

    Args:
        data: The recordings, and the rig as handed in.
        split: Its test time counts.
        windows, free: Errors on that time, over windows and in one run; made anew where absent.
        rigs: By text, what was read already.
    """

    def __init__(
        self, data: MachineData, split: Split, windows: WindowErrors | None = None, free: MachineRuns | None = None,
        rigs: dict[str, Rig] | None = None,
    ) -> None:  # fmt: skip
        self._data, self._split = data, split
        self._windows, self._free = windows or WindowErrors(data, split), free or MachineRuns(data, split)
        self._whole = MachineRuns(data, split, WINDOW)
        self._started = [MachineRuns(data, split, part=(number / STARTS, (number + 1) / STARTS)) for number in range(STARTS)]
        self._warmth_unknown = closed_gas(data)
        self.refusals: list[str] = []
        self._rigs = {} if rigs is None else rigs

    def over(self, split: Split) -> Judge:
        """Return the judge by another time of the recordings: what was run already over all of it is not run again."""
        free = self._free.over(split) if set(split.test) == set(self._split.test) else None
        return Judge(self._data, split, self._windows.over(split), free, self._rigs)

    def trial(self, update: RigUpdate) -> Trial:
        """Return the errors of one update; why its rig is refused is kept in `refusals`."""
        data = self._data
        try:
            rig = self._rig(update)
            inside, run, coupled = self._windows.errors(rig), self._free.errors(rig), self._whole.errors(rig)
            # a part may be too short to show what feeds a chamber: only what the whole run predicts counts
            counted = set(run) - self._warmth_unknown
            begun = [{column: fit for column, fit in one.errors(rig).items() if column in counted} for one in self._started if counted]
            started = tuple(found for found in begun if found)
        except (RigError, ModelError) as refusal:
            self.refusals.append(str(refusal))
            return Trial(update, {}, {}, {}, is_refused=True)
        spreads = {column: spread_of(data, column) for column in {*inside, *run, *coupled}}
        floors = {column: fit.noise for column, fit in coupled.items()}
        return Trial(update, inside, run, spreads, coupled, uncertainty(self._whole.by_block(rig), floors), started)

    def reported(self, trial: Trial, split: Split) -> Trial:
        """Return a trial with its errors on the test time of another split."""
        rig = self._rig(trial.update)
        return replace(trial, windows=self._windows.over(split).errors(rig), free_run=self._free.over(split).errors(rig))

    def _rig(self, update: RigUpdate) -> Rig:
        """Return the rig as its text will be read: the same one for the same text."""
        text = update.text(self._data.rig.path.parent)
        if text not in self._rigs:
            self._rigs[text] = parse(text, self._data.rig.path)
        return self._rigs[text]


def closed_gas(data: MachineData) -> set[str]:
    """Return the pressures of cylinders that no valve feeds.

    A run begun in the midst of their motion begins with a gas whose temperature nobody measured, and which no fresh gas takes the place
    of: walls then make of a good rig a bad one.
    """
    closed = [name for name, runs in data.cylinders.items() if not any(run.commanded for run in runs)]
    return {f"{name}.pressure_{side}" for name in closed for side in (1, 2)}


def accepted(
    data: MachineData, update: RigUpdate, split: Split, is_spent: IsSpent = never, fitted: RigUpdate | None = None
) -> tuple[Trial, tuple[str, ...]]:
    """Return as much of an update as wins, with its errors, and remarks: what was left out and why, or that nothing could be tried.

    Validation time chooses. That is not all that was held out, and what is worse over all of it (as of `Trial.is_worse`) is cut down until
    it is not; then it is said that the reported errors are of time that chose. One free run over all of it may still stray further with
    the rig that is written, where runs from several measured states are surely better.

    Args:
        data: The recordings, and the rig as handed in.
        update: What was found.
        split: What wins over its validation time is taken, or over the test time where there is no other; errors are of the test time.
        is_spent: Whether the time is up: then it is all of the update, or nothing.
        fitted: The same update with numbers that were fitted to the whole machine: it takes the other's place where it wins.
    """
    judge = Judge(data, split.deciding())
    plain = update
    if fitted is not None and fitted is not update and not is_spent():
        update = better_of(judge.trial(update), judge.trial(fitted)).update
    best, by_all = as_far_as_it_wins(update, judge.trial, is_spent), False
    if update is fitted and best.update.parts != update.parts and best.update.parts and not is_spent():
        best = better_of(replace(judge.trial(plain.with_parts_of(best.update)), is_first=False), best)
    refusals = judge.refusals
    if split.validation:
        if best.update.parts:
            last = judge.over(split.kept_back())
            on_all = last.trial(best.update)
            by_all = on_all.is_worse
            best = as_far_as_it_wins(best.update, last.trial, is_spent) if by_all else replace(best, starts=on_all.starts)
        best = judge.reported(best, split)
    is_cut, is_unproved = best.update.parts != update.parts and not refusals, bool(best.update.parts) and not best.is_proved
    said = ((_CUT.format(update.without(best.update)), is_cut), (_UNPROVED, is_unproved), (_BY_ALL, by_all))
    unsayable = [_UNSAYABLE.format(wording.name_of(entry.setting.name), entry.setting.where) for entry in update.unsayable]
    chance = [_BY_CHANCE.format(column, count, ratio) for column, (ratio, count) in best.by_chance().items()]
    return best, (*(_REFUSED.format(why) for why in refusals[:1]), *(words for words, is_so in said if is_so), *unsayable, *chance)


def likelier(data: MachineData, update: RigUpdate, other: RigUpdate, split: Split, is_spent: IsSpent = never) -> RigUpdate:
    """Return which of two updates predicts the whole machine better over the time that decides, the first where they are alike.

    Args:
        data, split, is_spent: As of `accepted`.
        update, other: The same thing said in two ways.
    """
    if other == update or is_spent():
        return update
    judge = Judge(data, split.deciding())
    return better_of(judge.trial(update), judge.trial(other)).update


def better_of(one: Trial, other: Trial) -> Trial:
    """Return the trial that is not worse than the rig handed in, of two alike the one whose whole machine is predicted better."""
    return min(one, other, key=lambda trial: (trial.is_worse, trial.loss_of_machine))


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
    def tried_after(one: RigUpdate) -> Trial:
        return replace(tried(one), is_first=False)

    best, trials = tried(update), 1
    while best.update.parts and (best.is_worse or best.hurts):
        fewer = [tried_after(one) for one in best.update.reduced()] if trials < MOST_TRIALS and not is_spent() else []
        trials += len(fewer)
        next_best = min(fewer, key=lambda one: (one.is_worse, one.loss), default=None)
        if next_best is None:
            break
        if not best.is_worse and (next_best.is_worse or next_best.loss > best.loss - WORTH_LEAVING_OUT):
            break
        best = next_best
    if not best.is_worse and (best.update.parts or not update.parts):
        return best
    alone = [] if is_spent() else [trial for trial in map(tried_after, update.found_alone()) if not trial.is_worse]
    if alone:
        return min(alone, key=lambda one: one.loss)
    return tried(RigUpdate(update.rig, ())) if best.update.parts else best
