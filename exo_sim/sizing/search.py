"""The search: Optuna's NSGA-II proposes designs in this process and takes their scores, designs are scored wherever workers are.

The first half of the designs is for the whole front. Four objectives leave few designs bettered by others, so that half does not
press for what somebody would buy; the second half goes on from its best with enough margin and tracking as constraints, for gas and mass.

Every batch's draws depend on the seed, its number and the scores before it, never on who scored or when. So the same seed
gives the same front with any workers; and after a kill the same draws come again, and whatever the journal holds is not scored anew.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from exo_sim import progress
from exo_sim.sizing.design import Design
from exo_sim.sizing.design_space import MOST_ABOVE, Space
from exo_sim.sizing.evaluation import ENOUGH_MARGIN, ENOUGH_TRACKING, Score, Task, largest_torque
from exo_sim.sizing.loads import joint_loads
from exo_sim.sizing.search_journal import DIRECTIONS, SearchJournal
from exo_sim.sizing.workers import Workers

if TYPE_CHECKING:
    import optuna

#: Designs asked for together, and NSGA-II's population: fixed, so that the number of workers does not matter.
BATCH = 40
#: Share of the pressure limit that the second half keeps free: the demand of `exo-sim run` presses the gas harder.
_HEADROOM = 0.05


@dataclass(frozen=True)
class Found:
    """A design, its score, and the variables that stand for it."""

    design: Design
    score: Score
    numbers: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Outcome:
    """What a search came to.

    Attributes:
        trials: All designs with their scores, in the order of their numbers.
        front: Those of the feasible ones that no other betters in every objective, by falling margin.
        new: How many were scored now; the others came from the journal.
        interrupted: True where Ctrl-C ended it early.
    """

    trials: tuple[Found, ...]
    front: tuple[Found, ...]
    new: int
    interrupted: bool = False


def search(
    task: Task,
    trials: int,
    seed: int,
    workers: Workers,
    journal: Path | None = None,
    quiet: bool = True,
) -> Outcome:
    """Look for the best designs.

    Args:
        task: What they are judged by.
        trials: How many designs; the first is the owner's, as near as the space allows.
        seed: Of all draws.
        workers: Who scores.
        journal: Optuna journal that keeps finished designs; read where it is there.
        quiet: No progress bar.

    Raises:
        OutputError: the journal belongs to another search.
    """
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    space = task.space
    book = SearchJournal(journal, f"{task.digest} seed {seed}")
    study = optuna.create_study(directions=list(DIRECTIONS), sampler=_sampler(seed, 0))
    distributions = _distributions(space)
    for first in workers.first_designs(task, min(BATCH, trials), seed):
        study.enqueue_trial({name: _as_asked(first[name], within) for name, within in distributions.items()})
    found: list[Found] = []
    new, interrupted = 0, False
    narrow: float | None = None
    half = BATCH * math.ceil(trials / (2 * BATCH))
    loads = tuple(joint_loads(task.rig, condition) for condition in task.conditions)
    most_error = ENOUGH_TRACKING * largest_torque(loads, tuple(joint for kind in space.kinds for joint in kind.joints))
    with progress.Bar(trials, "sizing", unit="design", quiet=quiet) as bar:
        try:
            for start in range(0, trials, BATCH):
                study.sampler = _sampler(seed, start, start >= half)
                if start == half:
                    narrow, study = most_error, _narrowed(found, most_error, distributions, study.sampler)
                numbers = range(start, min(start + BATCH, trials))
                asked = [_ask(study, distributions) for _ in numbers]
                kept = [book.score(number, trial.params) for number, trial in zip(numbers, asked)]
                missing = [trial.params for trial, score in zip(asked, kept) if score is None]
                fresh = workers.scores(task, missing)
                for number, trial, score in zip(numbers, asked, kept):
                    if score is None:
                        score = next(fresh)
                        book.keep(number, trial.params, score, distributions)
                        new += 1
                    _tell(study, trial, score, narrow)
                    found.append(Found(space.design(trial.params, score.bores, number, score.springs), score, trial.params))
                    bar.advance()
        except KeyboardInterrupt:
            interrupted = True
    return Outcome(tuple(found), front_of(found), new, interrupted)


def with_more(
    task: Task, outcome: Outcome, more: Sequence[Mapping[str, Any]], seed: int, workers: Workers, journal: Path | None = None
) -> Outcome:
    """Return what a search came to with some more designs, given as variables, among its own; the journal keeps these, too."""
    book, distributions = SearchJournal(journal, f"{task.digest} seed {seed}"), _distributions(task.space)
    own = [one.numbers for one in outcome.trials]
    first = len(own)
    others = [dict(numbers) for i, numbers in enumerate(more) if numbers not in own and numbers not in more[:i]]
    kept = [book.score(first + i, numbers) for i, numbers in enumerate(others)]
    fresh = workers.scores(task, [numbers for numbers, score in zip(others, kept) if score is None])
    found = list(outcome.trials)
    for i, (numbers, score) in enumerate(zip(others, kept)):
        if score is None:
            score = next(fresh)
            book.keep(first + i, numbers, score, distributions)
        found.append(Found(task.space.design(numbers, score.bores, first + i, score.springs), score, numbers))
    return Outcome(tuple(found), front_of(found), outcome.new + sum(score is None for score in kept))


def front_of(found: Sequence[Found]) -> tuple[Found, ...]:
    """Return the feasible designs that no other equals or betters in every objective, by falling margin."""
    good = [one for one in found if one.score.feasible]
    if not good:
        return ()
    costs = np.array([(-one.score.objectives[0], *one.score.objectives[1:]) for one in good])
    out = []
    for i, one in enumerate(good):
        better = np.all(costs <= costs[i], axis=1) & np.any(costs < costs[i], axis=1)
        same = np.all(costs[:i] == costs[i], axis=1)
        if not better.any() and not same.any():
            out.append(one)
    return tuple(sorted(out, key=lambda one: (-one.score.margin, one.score.gas, one.design.number)))


def _sampler(seed: int, number: int, narrow: bool = False) -> optuna.samplers.NSGAIISampler:
    import optuna

    drawn = int(np.random.SeedSequence([seed, number]).generate_state(1)[0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        crossover = optuna.samplers.nsgaii.SBXCrossover()
        if not narrow:
            return optuna.samplers.NSGAIISampler(seed=drawn, population_size=BATCH, crossover=crossover)
        mutation = optuna.samplers.nsgaii.PolynomialMutation()
        return optuna.samplers.NSGAIISampler(
            seed=drawn, population_size=BATCH // 2, crossover=crossover, mutation=mutation, mutation_prob=0.3
        )


def _distributions(space: Space) -> dict[str, Any]:
    import optuna

    out: dict[str, Any] = {}
    for kind in space.kinds:
        out[f"{kind.name}.above"] = optuna.distributions.IntDistribution(0, MOST_ABOVE)
    for name, (low, high) in space.bounds.items():
        out[name] = optuna.distributions.FloatDistribution(low, high, log=name.endswith(".valve"))
    return out


def _as_asked(value: float, within: Any) -> float | int:
    """Return a number of a first design as the sampler takes it: rounded out of a range, of one size say, it is refused."""
    import optuna

    inside = min(max(value, within.low), within.high)
    return int(inside) if isinstance(within, optuna.distributions.IntDistribution) else inside


def _ask(study: optuna.Study, distributions: dict[str, Any]) -> optuna.Trial:
    trial = study.ask(distributions)
    trial.relative_params  # noqa: B018  puts designs that were enqueued, too, into a generation
    return trial


def _tell(study: optuna.Study, trial: optuna.Trial, score: Score, most_error: float | None = None) -> None:
    """Hand a score to the study; with a largest error as one of gas and mass alone, enough margin and tracking being constraints."""
    narrow = most_error is not None
    for i, violation in enumerate(_narrow_violations(score, most_error) if narrow else score.violations):
        trial.set_constraint(str(i), violation)
    study.tell(trial, score.objectives[1:3] if narrow else score.objectives)


def _narrow_violations(score: Score, most_error: float | None) -> tuple[float, ...]:
    late = score.error / most_error - 1.0 if most_error and score.finished else 0.0
    tight = score.violations[-1] + _HEADROOM if score.finished else 0.0
    return *score.violations, ENOUGH_MARGIN - score.margin, late, tight


def _narrowed(
    found: list[Found], most_error: float, distributions: dict[str, Any], sampler: optuna.samplers.NSGAIISampler
) -> optuna.Study:
    """Return a study of gas and mass whose first generation are the best so far."""
    import optuna

    study = optuna.create_study(directions=["minimize", "minimize"], sampler=sampler)

    def rank(one: Found) -> tuple[float, float]:
        over = sum(max(violation, 0.0) for violation in _narrow_violations(one.score, most_error))
        return over, one.score.gas * one.score.mass

    for one in sorted(found, key=rank)[: BATCH // 2]:
        study.enqueue_trial(dict(one.numbers))
        _tell(study, _ask(study, distributions), one.score, most_error)
    return study
