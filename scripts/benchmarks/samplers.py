"""What samplers of Optuna find in the same processor time: the search as it is against plain NSGA-II, NSGA-III and TPE."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.figure import Asked, Figure, Said
from benchmarks.walking_machine import ROOT
from exo_sim import rig
from exo_sim.sizing.design_space import MOST_ABOVE
from exo_sim.sizing.evaluation import ENOUGH_MARGIN, ENOUGH_TRACKING, Score, Task, evaluator, largest_torque
from exo_sim.sizing.loads import Condition
from exo_sim.sizing.search import BATCH, search
from exo_sim.sizing.search_journal import DIRECTIONS
from exo_sim.sizing.study import space_of
from exo_sim.sizing.workers import Workers

#: Processor time that each gets with each seed [s], and the seeds.
SECONDS, SEEDS = 6.0, (0, 1, 2)
#: How near to that time a search of a fixed number of designs must end, as a share of it, and how often it is tried with another number.
CLOSE, TRIES = 0.05, 4
#: What a design is thought to take before any was judged [s].
_FIRST_GUESS = 0.01
#: The worst gas [kg], mass [kg] and error [N m] that still count; less of each, and margin from 0 to 1, make the volume.
WORST = np.array([0.025, 18.0, 8.0])
_POINTS = 8000


@dataclass(frozen=True)
class Seen:
    """A score and the processor time at which it was there [s]."""

    time: float
    score: Score


class _Clocked(Workers):
    """Scores in this process, and keeps when each was there."""

    def __init__(self) -> None:
        super().__init__(1)
        self.seen: list[Seen] = []
        self.begun = time.process_time()

    def scores(self, task: Task, designs: list[dict[str, float]]) -> Iterator[Score]:
        judge = evaluator(task)
        for numbers in designs:
            score = judge.score(numbers)
            self.seen.append(Seen(time.process_time() - self.begun, score))
            if self.seen[-1].time > SECONDS:
                raise KeyboardInterrupt
            yield score


def ours(task: Task, seed: int, known: list[float]) -> list[Seen]:
    """Search as `exo-sim size` does, half for the front and half for what would be bought, as many designs as the time allows.

    How many these are is not known before, and the halves are those of a search of that length: so it is run anew until it ends within
    `CLOSE` of the time, and the run that ends nearest to it counts. Only that run's time counts.

    Args:
        task: What designs are judged by.
        seed: Of all draws.
        known: Seconds a design took in runs before; the newest at the end, which this one is added to.
    """
    runs: list[tuple[float, list[Seen]]] = []
    for _ in range(TRIES):
        trials = max(round(SECONDS / known[-1]), 2)
        with _Clocked() as workers:
            search(task, trials, seed, workers)
        end = workers.seen[-1].time
        known.append(end / len(workers.seen))
        whole = len(workers.seen) >= trials
        runs.append((abs(end / SECONDS - 1.0) if whole else 1.0 - len(workers.seen) / trials, workers.seen))
        if runs[-1][0] <= CLOSE:
            break
    return min(runs, key=lambda run: run[0])[1]


def by_sampler(task: Task, sampler: Any, seed: int) -> list[Seen]:
    """Let a sampler of Optuna look for the front alone, from the same first designs."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    space, judge, seen, begun = task.space, evaluator(task), [], time.process_time()
    known: dict[str, Any] = {f"{kind.name}.above": optuna.distributions.IntDistribution(0, MOST_ABOVE) for kind in space.kinds}
    for name, (low, high) in space.bounds.items():
        known[name] = optuna.distributions.FloatDistribution(low, high, log=name.endswith(".valve"))
    study = optuna.create_study(directions=list(DIRECTIONS), sampler=sampler)
    with Workers(1) as workers:
        for first in workers.first_designs(task, BATCH, seed):
            study.enqueue_trial({name: int(first[name]) if name.endswith(".above") else first[name] for name in known})
    while time.process_time() - begun < SECONDS:
        trial = study.ask(known)
        score = judge.score(trial.params)
        for i, violation in enumerate(score.violations):
            trial.set_constraint(str(i), violation)
        study.tell(trial, score.objectives)
        seen.append(Seen(time.process_time() - begun, score))
    return seen


def volume(seen: list[Seen], bought: bool, peak: float) -> float:
    """Return the share of a box that feasible designs dominate: of all four objectives, or of gas and mass of what one would buy.

    Args:
        seen: Designs.
        bought: Only those with enough margin and tracking, by gas and mass.
        peak: Largest torque wanted [N m].
    """
    good = [one.score for one in seen if one.score.feasible]
    if bought:
        good = [one for one in good if one.margin >= ENOUGH_MARGIN and one.error <= ENOUGH_TRACKING * peak]
    costs = np.array([[one.gas, one.mass, one.error] for one in good]).reshape(-1, 3) / WORST
    chance = np.random.default_rng(0)
    if bought:
        points = chance.uniform(size=(_POINTS, 2))
        return float(np.mean([np.any(np.all(costs[:, :2] <= point, axis=1)) for point in points]))
    short = np.array([1.0 - min(max(one.margin, 0.0), 1.0) for one in good])
    all_four = np.column_stack([short, costs])
    points = chance.uniform(size=(_POINTS, 4))
    return float(np.mean([np.any(np.all(all_four <= point, axis=1)) for point in points]))


def samplers(seed: int) -> dict[str, Any]:
    """Return the samplers that are held against ours, by name."""
    import optuna

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        return {
            "nsga2": optuna.samplers.NSGAIISampler(seed=seed, population_size=BATCH),
            "nsga3": optuna.samplers.NSGAIIISampler(seed=seed, population_size=BATCH),
            "tpe": optuna.samplers.TPESampler(seed=seed, n_startup_trials=BATCH, multivariate=True),
        }


def measure(asked: Asked) -> Said:
    """Return the mean volumes over the seeds, and how many designs each saw."""
    machine = rig.read(ROOT / "assets" / "exo_250_psi.toml")
    task = Task(machine, (Condition("level_walk", 34.0),), space_of(machine, 0.04, None))
    judge = evaluator(task)
    peak = largest_torque(judge.loads, tuple(joint for kind in judge.kinds for joint in kind.joints))
    judge.score(task.space.owners(machine))
    found: dict[str, list[list[Seen]]] = {}
    known = [_FIRST_GUESS]
    for seed in SEEDS:
        found.setdefault("ours", []).append(ours(task, seed, known))
        for name, sampler in samplers(seed).items():
            found.setdefault(name, []).append(by_sampler(task, sampler, seed))
    said = []
    for name, runs in found.items():
        within = [[one for one in run if one.time <= SECONDS] for run in runs]
        front, bought = ([volume(run, only, peak) for run in within] for only in (False, True))
        said += [
            Figure(f"{name}_time", f"{name}: processor time used", float(np.mean([run[-1].time for run in within])), "{:.2f} s"),
            Figure(f"{name}_designs", f"{name}: designs in {SECONDS:g} s", float(np.mean([len(run) for run in within])), "{:.0f}"),
            Figure(f"{name}_front", f"{name}: volume of all four objectives", float(np.mean(front)),
                   "{:.4f} of the box, over the seeds " + ", ".join(f"{each:.3f}" for each in front)),
            Figure(f"{name}_bought", f"{name}: volume of gas and mass, enough margin and tracking", float(np.mean(bought)),
                   "{:.4f} of the box, over the seeds " + ", ".join(f"{each:.3f}" for each in bought)),
        ]  # fmt: skip
    return said
