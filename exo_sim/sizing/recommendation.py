"""Which design of a front to recommend, and why."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.rig import Rig
from exo_sim.sizing.confirmation import Confirmed, confirm, confirm_disturbed
from exo_sim.sizing.design import fitted
from exo_sim.sizing.evaluation import ENOUGH_MARGIN, ENOUGH_TRACKING, OF_THE_MACHINE, Task, largest_torque
from exo_sim.sizing.loads import Condition, JointLoads
from exo_sim.sizing.screening import CONSTRAINTS
from exo_sim.sizing.search import Found, Outcome

#: Largest torque error when `exo-sim run` asks for its own demand, as a share of the largest torque wanted.
ENOUGH_IN_RUN = 0.05
#: Places in the shortlist that are walked with until one is good: neighbours are alike, so steps grow.
_WALKED = (0, 1, 2, 4, 7, 11, 16, 24, 36, 54)
#: What became of designs that keep every constraint.
BETTERED, ON_THE_FRONT = "can be built, bettered by another", "on the front"

#: What lets designs through that a constraint keeps out.
WAYS_OUT = {
    "dead centre": "allow more room (--reach), or move the attachment points",
    "stroke": "ask for less travel (--travel task), or give longer strokes (--catalogue)",
    "length": "ask for less travel (--travel task), allow more room (--reach), or give shorter cylinders (--catalogue)",
    "buckling": "allow less pressure (--pressure-limit), or give thicker rods (--catalogue)",
    "rating": "allow less pressure (--pressure-limit), or give cylinders that stand more (--catalogue)",
    "torque": "allow more pressure (--pressure-limit), more room (--reach), larger bores (--catalogue), or less payload",
    "joints not sized": "size them as well (--joints), or allow more pressure (--pressure-limit)",
    "coupled cycle": "give larger dead volumes or smaller valves, more trials, or less payload",
    "chamber pressure": "allow more pressure (--pressure-limit), more trials, or less payload",
}


@dataclass(frozen=True)
class Walked:
    """What walking with a design of the shortlist gave, under the condition that was worst of those it was walked under.

    Error [N m], largest pressure and its limit [Pa], why it failed or "", that condition, and the largest error that is allowed [N m].
    """

    number: int
    error: float
    peak: float
    limit: float
    trouble: str
    condition: str = ""
    most_error: float = np.inf

    @property
    def fails(self) -> str:
        """What it fails in the closed loop, in words; "" where it keeps to its limits."""
        if self.trouble:
            return self.trouble
        beyond = [
            f"{what} beyond {most / unit:.1f} {of}"
            for what, value, most, unit, of in (
                ("error", self.error, self.most_error, 1.0, "N m rms"), ("pressure", self.peak, self.limit, 1e5, "bar"),
            )
            if not value <= most
        ]  # fmt: skip
        return " and ".join(beyond)


@dataclass(frozen=True)
class UnderCondition:
    """What the recommended design did in the closed loop of one condition, disturbed or not.

    What it was, gas a cycle [kg], error [N m], largest pressure [Pa], why it failed or "".
    """

    condition: str
    gas: float
    error: float
    peak: float
    trouble: str


@dataclass(frozen=True)
class Choice:
    """The recommended design, why in words, what walking with it gave where its margin is thinnest, and all that were walked with.

    `everywhere` is what it gave under each condition, the one of `condition` first; others are left out where an earlier one failed.
    """

    found: Found
    why: str
    confirmed: Confirmed
    condition: Condition
    walked: tuple[Walked, ...] = ()
    everywhere: tuple[UnderCondition, ...] = ()


@dataclass(frozen=True)
class Shortlist:
    """Designs worth walking with.

    Attributes:
        designs: The cheapest first.
        words: What they have that others have not.
        peak: Largest torque wanted of any joint [N m].
    """

    designs: tuple[Found, ...]
    words: str
    peak: float


def shortlist(front: tuple[Found, ...], loads: tuple[JointLoads, ...], joints: tuple[str, ...]) -> Shortlist:
    """Return the designs of a front that keep torque in hand and track well, those that cost least first.

    Cost is gas and mass, each relative to the least among them, added.

    Args:
        front: Not empty.
        loads: What the joints must carry.
        joints: Those that have cylinders.
    """
    peak = largest_torque(loads, joints)
    most_error = ENOUGH_TRACKING * peak
    strong = [one for one in front if one.score.margin >= ENOUGH_MARGIN]
    good = [one for one in strong if one.score.error <= most_error]
    if good:
        words = (
            f"of {len(front)} designs on the Pareto front, {len(good)} have a torque margin of at least {100 * ENOUGH_MARGIN:.0f} % of the "
            f"peak and follow the torque within {most_error:.1f} N m rms ({100 * ENOUGH_TRACKING:g} % of the peak)"
        )
    elif strong:
        good = [one for one in strong if one.score.error <= 1.25 * min(each.score.error for each in strong)]
        words = (
            f"{len(strong)} designs have a torque margin of {100 * ENOUGH_MARGIN:.0f} % of the peak, but none follows the torque within "
            f"{most_error:.1f} N m rms; {len(good)} come within a quarter of the best error"
        )
    else:
        good = list(front[:1])
        words = (
            f"no design found has a torque margin of {100 * ENOUGH_MARGIN:.0f} % of the peak; this one has most. Allow more pressure "
            "(--pressure-limit), more room (--reach) or more trials"
        )
    least_gas, least_mass = _least(good)
    cost = {one.design.number: one.score.gas / (least_gas or 1.0) + one.score.mass / least_mass for one in good}
    return Shortlist(tuple(sorted(good, key=lambda one: (cost[one.design.number], one.design.number))), words, peak)


def recommended(
    front: tuple[Found, ...], loads: tuple[JointLoads, ...], task: Task, tell: Callable[[str], None] = lambda words: None
) -> Choice:
    """Return the cheapest of a front that keeps torque in hand and tracks well, in the search and in `exo-sim run`.

    Args:
        front: Not empty.
        loads: What the joints must carry, in the order of the task's conditions.
        task: What the designs were judged by.
        tell: Takes a remark.
    """
    kinds = task.space.kinds
    joints = tuple(joint for kind in kinds for joint in kind.joints)
    short = shortlist(front, loads, joints)
    tried: list[_Tried] = []
    for one in (short.designs[i] for i in _WALKED if i < len(short.designs)):
        tell(f"walking with design {one.design.number}")
        limits = ENOUGH_IN_RUN * short.peak, limit_of(one, task)
        tried.append(_walked_everywhere(one, task, loads, joints, limits))
        if tried[-1].excess <= 1.0:
            break
    at = len(tried) - 1
    if tried[at].excess > 1.0:
        at = min(range(len(tried)), key=lambda i: (-len(tried[i].walks), tried[i].excess))
    excess, best, walked = tried[at].excess, tried[at].found, tried[at].walks[0][1]
    limits = ENOUGH_IN_RUN * short.peak, limit_of(best, task)
    words = short.words
    if len(short.designs) > 1:
        least_gas, least_mass = _least(short.designs)
        if excess > 1.0:
            words += f"; of {len(tried)} that were walked with it comes nearest to the limits in the closed loop"
        else:
            words += "; of these it has the least gas and mass together"
            if at:
                words += f", but for {at} walked with that went beyond the limits in the closed loop and their like"
        words += (
            f": {1e3 * best.score.gas:.1f} g a cycle (least {1e3 * least_gas:.1f}) and {best.score.mass:.1f} kg "
            f"(least {least_mass:.1f})"
        )
    place = best.score.thinnest
    if place is not None:
        words += f". Its torque margin is lowest, {100 * best.score.margin:.0f} %, at {place[0]}, phase {place[2]:.2f} of {place[1]}"
    if walked.walk is not None:
        words += (
            f". In the closed loop of exo-sim run it follows within {walked.error:.1f} N m rms (limit {limits[0]:.1f}) and its chambers "
            f"reach {walked.peak / 1e5:.1f} bar (limit {limits[1] / 1e5:.1f})"
        )
    if len(tried[at].walks) > 1:
        gas = [found.gas for _, found in tried[at].walks]
        errors = [found.error for _, found in tried[at].walks]
        plain = min(len(gas), len(task.conditions))
        disturbances = f" and {len(gas) - plain} disturbances" if len(gas) > plain else ""
        words += (
            f". Over {plain} conditions{disturbances} "
            f"it draws {1e3 * float(np.mean(gas)):.2f} g a cycle in the mean, {1e3 * max(gas):.2f} g "
            f"at the most, and follows within {max(errors):.1f} N m rms"
        )
    everywhere = tuple(UnderCondition(place, found.gas, found.error, found.peak, found.trouble) for place, found in tried[at].walks)
    return Choice(best, words, walked, loads[_hardest(best, loads)].condition, tuple(one.worst(task) for one in tried), everywhere)


@dataclass(frozen=True)
class _Tried:
    """A design of the shortlist and its walks, the hardest condition's first; `excess` is the largest of all (`Confirmed.excess`)."""

    found: Found
    walks: tuple[tuple[str, Confirmed], ...]
    limits: tuple[float, float]

    @property
    def excess(self) -> float:
        return max(walk.excess(*self.limits) for _, walk in self.walks)

    def worst(self, task: Task) -> Walked:
        place, walk = max(self.walks, key=lambda item: item[1].excess(*self.limits))
        return Walked(self.found.design.number, walk.error, walk.peak, limit_of(self.found, task), walk.trouble, place, self.limits[0])


def _walked_everywhere(
    one: Found, task: Task, loads: tuple[JointLoads, ...], joints: tuple[str, ...], limits: tuple[float, float]
) -> _Tried:
    """Walk with a design under every condition, the hardest first, then the hardest disturbed, until one is beyond the limits."""
    rig, hardest = fitted(task.rig, task.space.kinds, one.design), _hardest(one, loads)
    order = [hardest, *(i for i in range(len(task.conditions)) if i != hardest)]
    walks: list[tuple[str, Confirmed]] = []
    for place, walk in _walks(rig, [task.conditions[i] for i in order], task.disturbed, joints):
        walks.append((place, walk if not walks else replace(walk, walk=None)))  # whole walks are large: one is shown
        if walk.excess(*limits) > 1.0:
            break
    return _Tried(one, tuple(walks), limits)


def _walks(rig: Rig, conditions: list[Condition], disturbed: bool, joints: tuple[str, ...]) -> Iterator[tuple[str, Confirmed]]:
    for condition in conditions:
        yield str(condition), confirm(rig, condition, joints)
    if disturbed:
        for one, walk in confirm_disturbed(rig, conditions[0], joints):
            yield f"{conditions[0]}; {one.name}", walk


def limit_of(found: Found, task: Task) -> float:
    """Return the largest pressure that a design's chambers may see, absolute [Pa]: the limit asked for, or a cylinder's rating."""
    return min(task.space.limit, *(joint.cylinder.rating for joint in found.design.joints.values()))


def fates(outcome: Outcome, task: Task) -> list[tuple[str, tuple[int, ...]]]:
    """Return what became of all designs of a search and their numbers: the first constraint that each fails; the rest at the end."""
    names = [f"failed: {kind.name}: {words}" for kind in task.space.kinds for words in CONSTRAINTS]
    names += [*(f"failed: {words}" for words in OF_THE_MACHINE), BETTERED, ON_THE_FRONT]
    numbers: dict[str, list[int]] = {name: [] for name in names}
    front = {one.design.number for one in outcome.front}
    for one in outcome.trials:
        passed = ON_THE_FRONT if one.design.number in front else BETTERED
        numbers[next((name for name, value in zip(names, one.score.violations) if value > 0.0), passed)].append(one.design.number)
    return [(name, tuple(found)) for name, found in numbers.items() if found or name in (BETTERED, ON_THE_FRONT)]


def _least(designs: list[Found] | tuple[Found, ...]) -> tuple[float, float]:
    return min(one.score.gas for one in designs), min(one.score.mass for one in designs)


def _hardest(found: Found, loads: tuple[JointLoads, ...]) -> int:
    """Return which condition leaves the thinnest margin."""
    place = found.score.thinnest
    return next((i for i, one in enumerate(loads) if place and str(one.condition) == place[1]), 0)


def nothing_found(outcome: Outcome, task: Task) -> ScenarioError:
    """Return the error that says what kept every design out."""
    violated = np.array([one.score.violations for one in outcome.trials]) > 0.0
    names = [f"{kind.name}: {words}" for kind in task.space.kinds for words in CONSTRAINTS] + list(OF_THE_MACHINE)
    worst = int(np.argmax(violated.mean(axis=0)))
    return ScenarioError(
        f"none of {len(outcome.trials)} designs carries {'; '.join(map(str, task.conditions))}: "
        f'"{names[worst]}" keeps {100 * violated[:, worst].mean():.0f} % of them out; {WAYS_OUT[names[worst].rpartition(": ")[2]]}'
    )
