"""What would change a recommendation: how far it is from each requirement, its neighbours, and what one requirement less would allow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from exo_sim.sizing.design import Design
from exo_sim.sizing.evaluation import ENOUGH_MARGIN, ENOUGH_TRACKING, OF_THE_MACHINE, Score, Task, evaluator, largest_torque
from exo_sim.sizing.loads import JointLoads
from exo_sim.sizing.recommendation import limit_of
from exo_sim.sizing.screening import CONSTRAINTS, LEAST_ARM
from exo_sim.sizing.search import Found, Outcome

#: Steps to a neighbour: of a pressure [Pa], of a valve's area (a factor), of an end's distance from the joint's axis [m].
_PRESSURE, _VALVE, _ARM = 5e4, 1.25, 5e-3


@dataclass(frozen=True)
class Requirement:
    """A requirement of a recommended design: what it has, what is required, in words, and the share of that which is left."""

    name: str
    has: str
    asked: str
    left: float


@dataclass(frozen=True)
class Neighbour:
    """A design one step away: what is different, its score, and which requirement it fails, "" where none."""

    what: str
    score: Score
    fails: str


@dataclass(frozen=True)
class Relaxed:
    """The cheapest design that fails one requirement alone: which, what it has of it in words, and the design."""

    requirement: str
    needs: str
    found: Found


@dataclass(frozen=True)
class Sensitivity:
    """What would change a recommendation; requirements by what is left, the tightest first."""

    requirements: tuple[Requirement, ...]
    neighbours: tuple[Neighbour, ...]
    relaxed: tuple[Relaxed, ...]


def sensitivity(task: Task, outcome: Outcome, chosen: Found, loads: tuple[JointLoads, ...]) -> Sensitivity:
    """Return how near the recommended design is to its requirements and what would have been chosen beside it.

    Args:
        task: What designs were judged by.
        outcome: Of the search.
        chosen: The recommended design.
        loads: What the joints must carry.
    """
    peak = largest_torque(loads, tuple(joint for kind in task.space.kinds for joint in kind.joints))
    judge = evaluator(task)
    neighbours = []
    for what, design in _steps(task, chosen):
        score = judge.judge(design)
        neighbours.append(Neighbour(what, score, _fails(score, task, peak)))
    return Sensitivity(_requirements(task, chosen, peak), tuple(neighbours), _relaxed(outcome, chosen, peak))


def _requirements(task: Task, chosen: Found, peak: float) -> tuple[Requirement, ...]:
    score, limit = chosen.score, limit_of(chosen, task)
    out = [
        Requirement("torque margin", f"{100 * score.margin:.0f} %", f"{100 * ENOUGH_MARGIN:.0f} %", score.margin / ENOUGH_MARGIN - 1.0),
        Requirement(
            "torque error in the search", f"{score.error:.2f} N m rms", f"{ENOUGH_TRACKING * peak:.2f} N m rms",
            1.0 - score.error / (ENOUGH_TRACKING * peak),
        ),
        Requirement("chamber pressure", f"{score.peak / 1e5:.1f} bar", f"{limit / 1e5:.1f} bar", 1.0 - score.peak / limit),
    ]  # fmt: skip
    names = [f"{kind.name}: {words}" for kind in task.space.kinds for words in CONSTRAINTS if words not in ("stroke", "torque")]
    at = [i for i, words in enumerate([w for _ in task.space.kinds for w in CONSTRAINTS]) if words not in ("stroke", "torque")]
    said = {
        "dead centre": "least moment arm", "length": "room between the pivots", "buckling": "buckling, five-fold",
        "rating": "supply against rating",
    }  # fmt: skip
    for name, i in zip(names, at):
        kind, words = name.split(": ")
        left = -score.violations[i]
        out.append(Requirement(f"{kind}: {said[words]}", f"{100 * left:.0f} % to spare", "none", left))
    return tuple(sorted(out, key=lambda one: one.left))


def _steps(task: Task, chosen: Found) -> Iterator[tuple[str, Design]]:
    """Yield the designs one step away in one number, with what is different."""
    space, design, numbers = task.space, chosen.design, dict(chosen.numbers)
    bores = dict(chosen.score.bores)

    def moved(**changes: float) -> Design:
        return space.design({**numbers, **changes}, bores, springs=chosen.score.springs)

    for sign in (-1.0, 1.0):
        supply = design.supply + sign * _PRESSURE
        low, high = space.bounds["supply"]
        if low <= supply <= high:
            yield f"supply {supply / 1e5:.1f} bar", replace(design, supply=supply)
        if design.recovery is not None:
            pressure = design.recovery.pressure + sign * _PRESSURE
            if space.atmosphere < pressure < design.supply:
                yield f"recovery tank {pressure / 1e5:.1f} bar", replace(design, recovery=replace(design.recovery, pressure=pressure))
    if not numbers or not bores:
        return
    for kind in space.kinds:
        allowed = space.bores(kind)
        rank = allowed.index(bores[kind.name])
        for other in (rank - 1, rank + 1):
            if 0 <= other < len(allowed):
                bore = space.catalogue.cylinders[allowed[other]].bore
                yield f"{kind.name}: bore {1e3 * bore:g} mm", space.design(
                    numbers, {**bores, kind.name: allowed[other]}, springs=chosen.score.springs
                )
        for factor in (1.0 / _VALVE, _VALVE):
            area = numbers[f"{kind.name}.valve"] * factor
            low, high = space.bounds[f"{kind.name}.valve"]
            if low <= area <= high:
                yield f"{kind.name}: valve {1e6 * area:.1f} mm²", moved(**{f"{kind.name}.valve": area})
        for end, words in (("to", "rod end"), ("from", "barrel end")):
            low, high = space.bounds[f"{kind.name}.{end}"]
            for step in (-_ARM, _ARM):
                distance = numbers[f"{kind.name}.{end}"] + step
                if low <= distance <= high:
                    yield f"{kind.name}: {words} {1e3 * distance:.0f} mm from the axis", moved(**{f"{kind.name}.{end}": distance})


def _fails(score: Score, task: Task, peak: float) -> str:
    """Return the first requirement that a design fails, with its number; "" where it keeps all of the search's."""
    names = [f"{kind.name}: {words}" for kind in task.space.kinds for words in CONSTRAINTS] + list(OF_THE_MACHINE)
    first = next((i for i, value in enumerate(score.violations) if value > 0.0), None)
    if first is not None:
        return fails_in_words(names[first], score.violations[first])
    if score.margin < ENOUGH_MARGIN:
        return f"torque margin {100 * score.margin:.0f} %, {100 * ENOUGH_MARGIN:.0f} % required"
    if not score.error <= ENOUGH_TRACKING * peak:
        return f"torque error {score.error:.2f} N m rms, {ENOUGH_TRACKING * peak:.2f} allowed"
    return ""


def fails_in_words(constraint: str, beyond: float) -> str:
    """Return what a design fails, for people.

    Args:
        constraint: Of `screening.CONSTRAINTS`, behind its kind of joint ("knee: torque"), or of `evaluation.OF_THE_MACHINE`.
        beyond: How far, as scores have it.
    """
    joint, _, name = constraint.rpartition(": ")
    share = f"{100 * beyond:.0f} %"
    words = {
        "dead centre": f"moment arm {share} below the {1e3 * LEAST_ARM:g} mm required",
        "stroke": "no stroke to be had is as long as its travel",
        "length": f"pivots {share} nearer than its shortest length",
        "buckling": f"push {share} beyond a fifth of what buckles its rod",
        "rating": f"supply {share} beyond its rating",
        "torque": f"torque short by {share} of its peak",
        "joints not sized": f"joints not sized: torque short by {share} of its peak",
        "coupled cycle": "the coupled cycle is not walked to its end",
        "chamber pressure": f"chambers {share} beyond their largest pressure",
    }[name]
    if name == "torque" and beyond > 1.0:  # more than all of it is missing: the gas brakes
        words = "valve too small for the joint's speed: the gas brakes instead of driving"
    return f"{joint}: {words}" if joint else words


def _relaxed(outcome: Outcome, chosen: Found, peak: float) -> tuple[Relaxed, ...]:
    """Return for each requirement the cheapest design of the search that fails it alone, where it is cheaper than the recommended one."""
    gas, mass = chosen.score.gas, chosen.score.mass

    def cost(one: Found) -> float:
        return one.score.gas / gas + one.score.mass / mass

    best: dict[str, Found] = {}
    for one in outcome.trials:
        score = one.score
        if not score.finished or max(score.violations[:-1]) > 0.0:
            continue
        failed = [
            name for name, kept in (
                ("torque margin", score.margin >= ENOUGH_MARGIN), ("torque error", score.error <= ENOUGH_TRACKING * peak),
                ("chamber pressure", score.violations[-1] <= 0.0),
            ) if not kept
        ]  # fmt: skip
        if len(failed) == 1 and cost(one) < 2.0 and (failed[0] not in best or cost(one) < cost(best[failed[0]])):
            best[failed[0]] = one
    needs = {
        "torque margin": lambda s: f"{100 * s.margin:.0f} % in place of {100 * ENOUGH_MARGIN:.0f} %",
        "torque error": lambda s: f"{s.error:.2f} N m rms in place of {ENOUGH_TRACKING * peak:.2f}",
        "chamber pressure": lambda s: f"{s.peak / 1e5:.1f} bar",
    }
    return tuple(Relaxed(name, needs[name](one.score), one) for name, one in sorted(best.items(), key=lambda item: cost(item[1])))


def cheaper(neighbour: Neighbour, chosen: Score) -> bool:
    """Return whether a neighbour has less gas and mass together, each relative to the recommended design's."""
    score = neighbour.score
    return bool(score.finished and np.isfinite(score.gas) and score.gas / chosen.gas + score.mass / chosen.mass < 2.0 - 1e-3)
