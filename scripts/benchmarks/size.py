"""Designs a second of the search for sizes, with one process and with two."""

from __future__ import annotations

import time

from benchmarks import step
from benchmarks.figure import Asked, Figure, Said
from benchmarks.walking_machine import ROOT
from exo_sim import rig
from exo_sim.sizing.evaluation import Task, evaluator
from exo_sim.sizing.loads import Condition
from exo_sim.sizing.study import space_of
from exo_sim.sizing.workers import Workers

DESIGNS = 100


def measure(asked: Asked) -> Said:
    """Measure designs a second and their cost in bare steps; every design survives screening; both take turns, the quickest counts."""
    machine = rig.read(ROOT / "assets" / "exo_250_psi.toml")
    task = Task(machine, (Condition("level_walk", 34.0),), space_of(machine, 0.04, None))
    judge = evaluator(task)
    with Workers(1) as alone:
        designs = [each for each in alone.first_designs(task, 40, 0) if judge.score(each).simulated] * DESIGNS
    designs = designs[:DESIGNS]
    taken = {1: float("inf"), 2: float("inf")}
    for _ in range(5):
        for jobs in taken:
            with Workers(jobs) as workers:
                list(workers.scores(task, designs[:20]))
                begun = time.perf_counter()
                list(workers.scores(task, designs))
                taken[jobs] = min(taken[jobs], time.perf_counter() - begun)
    one, two = DESIGNS / taken[1], DESIGNS / taken[2]
    cost = 1e6 / one / judge.steps / step.bare_step_us()
    return [
        Figure("designs_per_s_1", "size, one process", one, "{:.1f} designs a second"),
        Figure("designs_per_s_2", "size, two processes", two, "{:.1f} designs a second", above=100.0),
        Figure("two_processes_ratio", "two processes against one", taken[1] / taken[2], "{:.2f} times", above=1.8),
        Figure("design_steps", "steps of a design", judge.steps, "{:.0f}"),
        Figure("design_ratio", "a design", cost, "{:.2f} times as many bare steps"),
    ]
