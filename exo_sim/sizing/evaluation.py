"""A design's score: screened by capability first, then put through the coupled cycle where it survives."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from exo_sim.rig import Rig
from exo_sim.rig.control_step import longest_step
from exo_sim.sizing.coupled_stride import STEP, CoupledStride, Stride, mean_of
from exo_sim.sizing.design import Design, actuator_mass, fitted
from exo_sim.sizing.design_space import Space
from exo_sim.sizing.first_designs import first_design
from exo_sim.sizing.joint_kinds import JointKind
from exo_sim.sizing.loads import Condition, JointLoads, joint_loads
from exo_sim.sizing.screening import chosen_bores, screen
from exo_sim.sizing.springs import beside
from exo_sim.sizing.unsized_joints import kinds_left_alone, left_alone
from exo_sim.version import VERSION

#: What stands for gas [kg] and torque error [N m] of a design that was not simulated: worse than any that was.
UNKNOWN_GAS, UNKNOWN_ERROR = 1.0, 1000.0
#: Torque in hand, as a share of the peak, above which more is no better.
AMPLE_MARGIN = 1.0
#: Torque to keep in hand, as a share of the joint's peak: friction, wear and a stumble are not in the loads.
ENOUGH_MARGIN = 0.25
#: Largest torque error, as a share of the largest torque wanted.
ENOUGH_TRACKING = 0.03
#: Constraints of the whole machine, behind those of screening: whether joints that are not sized carry their loads with the supply that is
#: chosen, and two of the coupled cycle.
OF_THE_MACHINE = ("joints not sized", "coupled cycle", "chamber pressure")
#: Time step of a run [s]: a valve that settles its chamber sooner has no place in it.
RUN_STEP = 0.5 * STEP
#: Digits of a score that count, so that processors that round differently agree.
DIGITS = 6


@dataclass(frozen=True)
class Score:
    """How good a design is.

    Attributes:
        margin: Least torque left, as a share of the joint's peak torque; more is better.
        gas: Drawn a cycle by all cylinders, mean over conditions [kg].
        mass: Of all cylinders [kg].
        error: Rms of torque less torque demanded at the worst joint under the worst condition [N m].
        violations: Constraints, those of screening and then `OF_THE_MACHINE`; above zero is violated.
        simulated: Whether it survived screening and went through the coupled cycle.
        finished: Whether it came through.
        by_joint: Margin by kind of joint.
        thinnest: Joint, condition and phase where the margin is thinnest, or None.
        worst: Joint with the largest error.
        peak: Largest pressure in any chamber [Pa], 0 where it was not simulated.
        bores: Place in the catalogue by kind of joint.
        springs: Stiffness [N/m] and rest [m] of those beside the rods, by kind of joint.
        most_gas: Drawn a cycle under the condition that draws most [kg].
    """

    margin: float
    gas: float
    mass: float
    error: float
    violations: tuple[float, ...]
    simulated: bool
    finished: bool
    by_joint: dict[str, float] = field(default_factory=dict)
    thinnest: tuple[str, str, float] | None = None
    worst: str = ""
    peak: float = 0.0
    bores: dict[str, int] = field(default_factory=dict)
    springs: dict[str, tuple[float, float]] = field(default_factory=dict)
    most_gas: float = 0.0

    @property
    def feasible(self) -> bool:
        """Whether every constraint is kept and the coupled cycle was walked."""
        return self.finished and max(self.violations) <= 0.0

    @property
    def objectives(self) -> tuple[float, float, float, float]:
        """Margin up to `AMPLE_MARGIN` (to be large), gas, mass, error (to be small)."""
        return min(self.margin, AMPLE_MARGIN), self.gas, self.mass, self.error


@dataclass(frozen=True)
class Task:
    """What all designs of a search are judged by.

    Attributes:
        rig: The owner's machine.
        conditions: What it must do.
        space: What may be chosen.
        step: Of the coupled cycle [s].
        disturbed: Whether what is recommended must stand the disturbances of a walk, too (`sizing.disturbances`); scores do not ask.
    """

    rig: Rig
    conditions: tuple[Condition, ...]
    space: Space
    step: float = STEP
    disturbed: bool = False

    @cached_property
    def digest(self) -> str:
        """Short name of everything that a score depends on besides the design."""
        rig = self.rig
        of_rig = rig.text, rig.effects, rig.wearer, rig.ankle, rig.supply, rig.body_masses, rig.joint_factors, rig.cylinders
        text = repr((VERSION, OF_THE_MACHINE, of_rig, self.conditions, self.space, self.step))
        return hashlib.sha256(text.encode() + rig.model.read_bytes()).hexdigest()[:16]


class Evaluator:
    """Scores designs; everything that does not depend on the design is made once.

    Args:
        task: What they are judged by.
    """

    def __init__(self, task: Task):
        self.task = task
        self.kinds: tuple[JointKind, ...] = task.space.kinds
        self.loads: tuple[JointLoads, ...] = tuple(joint_loads(task.rig, condition) for condition in task.conditions)
        joints = tuple(joint for kind in self.kinds for joint in kind.joints)
        self._others = kinds_left_alone(task.rig, self.kinds)
        # where the largest supply that is allowed does not suffice for the others, none does: that is said, and not held against designs
        self._others_can = self._left_alone(task.space.bounds["supply"][1]) >= 0.0
        self._strides = [CoupledStride(task.rig, condition, task.step, joints=joints) for condition in task.conditions]

    @property
    def steps(self) -> int:
        """How many steps of person, machine and gas one design takes."""
        return sum(stride.steps for stride in self._strides)

    def score(self, numbers: Mapping[str, float]) -> Score:
        """Return the score of the design that a set of variables stands for (`Space`)."""
        task = self.task
        bores = chosen_bores(task.rig, task.space, self.loads, numbers)
        design = task.space.design(numbers, bores)
        springs = {}
        if task.space.springs:
            springs = beside(task.rig, self.kinds, self.loads[0], design)
            design = task.space.design(numbers, bores, springs=springs)
        return replace(self.judge(design), bores=bores, springs=springs)

    def judge(self, design: Design) -> Score:
        """Return the score of a design."""
        rig = self.task.rig
        screened = screen(rig, self.kinds, self.loads, design)
        weak = _rounded(-self._left_alone(design.supply)) if self._others_can else 0.0
        mass = actuator_mass(self.kinds, design)
        place = screened.thinnest
        seen = Score(
            margin=_rounded(screened.margin),
            gas=UNKNOWN_GAS,
            mass=_rounded(min(mass, 1e3)),
            error=UNKNOWN_ERROR,
            violations=(*(_rounded(value) for value in screened.violations), weak, 0.0, 0.0),
            simulated=False,
            finished=False,
            by_joint={name: _rounded(value) for name, value in screened.by_joint.items()},
            thinnest=None if place is None else (place.joint, place.condition, place.phase),
        )
        if not screened.survives or weak > 0.0:
            return seen
        chosen = fitted(rig, self.kinds, design)
        if any(longest_step(chosen, cylinder) < RUN_STEP for cylinder in chosen.cylinders.values()):
            return replace(seen, violations=(*seen.violations[:-2], 1.0, 0.0))
        found = self.coupled(chosen)
        if not found.finished:
            return replace(seen, simulated=True, violations=(*seen.violations[:-2], 1.0, 0.0))
        gas, error = _rounded(found.gas), _rounded(found.error)
        peak = _rounded(found.peak)
        ratings = [design.joints[kind.name].cylinder.rating for kind in self.kinds]
        over = _rounded(peak / min(self.task.space.limit, *ratings) - 1.0)
        return replace(
            seen, simulated=True, finished=True, gas=gas, most_gas=_rounded(found.most_gas), error=error, worst=found.worst, peak=peak,
            violations=(*seen.violations[:-1], over),
        )  # fmt: skip

    def _left_alone(self, supply: float) -> float:
        """Return the least torque in hand of the joints that are not sized, as a share of their peak; 1 where there are none."""
        return min((one.margin for one in left_alone(self.task.rig, self._others, self.loads, supply)), default=1.0)

    def coupled(self, rig: Rig) -> Stride:
        """Put a fitted rig through the cycle of every condition; return gas and error over all of them."""
        return mean_of([stride.run(rig) for stride in self._strides])


def _rounded(value: float) -> float:
    return float(np.format_float_scientific(value, precision=DIGITS - 1))


def largest_torque(loads: tuple[JointLoads, ...], joints: tuple[str, ...]) -> float:
    """Return the largest torque that any of some joints must carry [N m]."""
    return max(float(np.abs(one.column(joint)[2]).max()) for one in loads for joint in joints)


_held: dict[str, Evaluator] = {}


def evaluator(task: Task) -> Evaluator:
    """Return this process's evaluator of a task, made at the first call; the last two stay."""
    if task.digest not in _held:
        while len(_held) > 1:
            del _held[next(iter(_held))]
        _held[task.digest] = Evaluator(task)
    return _held[task.digest]


def score_all(task: Task, designs: list[dict[str, float]]) -> list[Score]:
    """Return the scores of some designs, given as variables: what a worker is sent."""
    judge = evaluator(task)
    return [judge.score(numbers) for numbers in designs]


def first_of_all(task: Task, numbers: list[int], seed: int) -> list[dict[str, float]]:
    """Return some of the first designs, as variables: what a worker is sent before any score is known."""
    loads = evaluator(task).loads
    return [first_design(task.rig, task.space, loads, number, seed) for number in numbers]
