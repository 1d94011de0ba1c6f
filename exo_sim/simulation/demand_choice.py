"""Which of several rehearsed demands a causal controller is given: the one that serves best where something is not as it was rehearsed.

Rehearsals end in one of several demands that cost nearly the same as calibrated, and very different things where straps are otherwise or
the phase is wrong: what strap forces then change can set the machine swinging. No linear answer tells these apart, so each finalist is
walked with the controller that it is for, under each of a few disturbances, and that of the best worst case is taken. A demand does more
harm early than late, or the other way round; so it may also be played a little later than it was rehearsed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from exo_sim.control.causal import Calibration, Causal
from exo_sim.control.least_load import LeastLoad
from exo_sim.deciding_number import Count, Number
from exo_sim.errors import Diverged
from exo_sim.simulation.rehearsal import counted
from exo_sim.simulation.walk import Walk
from exo_sim.simulation.wearer_inverse_dynamics import Held
from exo_sim.simulation.wearer_load import hung, with_machine, with_payload
from exo_sim.simulation.work_balance import compared

if TYPE_CHECKING:
    from exo_sim.simulation.worn import Simulation

FINALISTS = Count(
    6, "demands", "the last rehearsals that bettered all before them: earlier ones cost more as calibrated",
    "9, 8.6 and 8.5 bar, every rehearsal that bettered: with 8.5 bar the last two cost twice the backpack on straps half as stiff, the "
    "four before them no more than the backpack; all but the first two or three of a rehearsal cost within a tenth as calibrated",
)  # fmt: skip
DEARER = Number(
    1.1, "times the least cost", "what a finalist may cost as rehearsed: robustness is not bought with more than the estimate can tell",
    "see the number of finalists",
)  # fmt: skip
LATER = tuple(
    Number(
        one, "strides", "how much later than rehearsed a demand may be played",
        "9 and 8.6 bar, uncorrected phase 3 % late and early: 0.4 % later brought the worse of both from 1.11 and 1.05 of the backpack's "
        "work to 1.00 and 0.97; 1.2 % later swung on soft straps (2.1)",
    )
    for one in (0.002, 0.004, 0.0, 0.006)
)  # fmt: skip
FINER = Number(
    0.001, "strides", "how much earlier and later than the best of these a demand is tried at last",
    "8.6 bar: uncorrected phase 3 % late and early 0.98 and 0.99 of the backpack's work with 0.4 %, 1.00 and 0.97 with 0.6 %",
)  # fmt: skip
STRIDES = Count(
    12, "strides", "what a disturbed walk of the choice lasts, without those that rehearsals leave out: what is learnt changed it by then",
    "with 9 a late and an early phase that are not corrected took 0.98 and 0.98 of the backpack's work and 0.99 and 0.91 of its power, "
    "three strides later 0.99 and 0.96, and 1.00 and 0.89: the demand was played too late for what was learnt",
)  # fmt: skip


@dataclass(frozen=True)
class Disturbance:
    """What is otherwise in a walk of the choice.

    Attributes:
        late: How late encoders give the phase throughout, strap forces not correcting it [strides].
        stiffness: Of the straps, as a factor; damping grows with its root.
    """

    late: float = 0.0
    stiffness: float = 1.0


#: Those that cost most where a demand is ill chosen; worst first, so that few walks tell that another is no better. Cadence, payload,
#: posture, uneven strides and other wearers are left to docs/walking.md, which reports on these here as well.
DISTURBANCES = (Disturbance(late=-0.03), Disturbance(stiffness=0.5), Disturbance(late=0.03), Disturbance(stiffness=2.0))


class _Played(NamedTuple):
    """A plan, how much later it is played [strides], its calibration, and the worst of its disturbed walks."""

    worst: float
    calibration: Calibration
    plan: LeastLoad
    late: float


class Choice:
    """Walks with causal control under `DISTURBANCES`.

    Args:
        it: Walks; its straps, cycles and demand are as before after that, and nobody's controller asks for torques.
    """

    def __init__(self, it: Simulation) -> None:
        self._it = it
        self._backpack: tuple[float, float] | None = None

    def of(self, plans: Sequence[LeastLoad], calibration: Callable[[LeastLoad], Calibration]) -> Calibration:
        """Return the calibration of the best worst case: first of the plans, then of how much later that one is played.

        Args:
            plans: The finalists.
            calibration: Walks with a plan's best torques.
        """
        first, *others = LATER
        best = _Played(math.inf, calibration(plans[-1]), plans[-1], 0.0)
        for plan in reversed(plans):
            best = self._better(best, plan, first, calibration)
        for late in others:
            best = self._better(best, best.plan, late, calibration)
        middle = best.late
        for beside in (middle - FINER, middle + FINER):
            best = self._better(best, best.plan, beside, calibration)
        return best.calibration

    def _better(self, best: _Played, plan: LeastLoad, late: float, calibration: Callable[[LeastLoad], Calibration]) -> _Played:
        """Return the better of one that was walked and a plan that is played so much later [strides]."""
        it = calibration(plan.later(late))
        found = self.worst(it, best.worst)
        return _Played(found, it, plan, late) if found < best.worst else best

    def worst(self, calibration: Calibration, least: float = math.inf) -> float:
        """Return the worst of the disturbed walks: metabolic power or work of the wearer's joints over that with a backpack.

        Args:
            calibration: Of the demand.
            least: Once one is worse than this the others need not be walked.
        """
        it, found = self._it, 0.0
        usual, cycles = it.straps, it.cycles
        it.cycles, controller = STRIDES, Causal(calibration)
        try:
            for one in DISTURBANCES:
                it.straps = usual.stiffened(one.stiffness)
                controller.late, controller.corrects = one.late, one.late == 0.0
                it.controlled_by(controller, seed=it.seed)
                it.reset()
                found = max(found, self._share(it.run()))
                if found > least:
                    break
        except Diverged:
            found = math.inf
        finally:
            it.straps, it.cycles = usual, cycles
            it.left_alone()
        return found

    def _share(self, walk: Walk) -> float:
        if self._backpack is None:
            self._backpack = _costs(with_payload(walk, float(walk.payload[-1]) + hung(walk)), walk)
        seen = walk.part(counted(walk, self._it.settling))
        return max(one / other for one, other in zip(_costs(with_machine(seen), seen), self._backpack))


def _costs(it: Held, walk: Walk) -> tuple[float, float]:
    """Return metabolic power [W] and what the wearer's joints give [J a stride]."""
    found = compared(it, walk)
    return found["metabolic_w"], sum(pair[0] for pair in found["wearer_joints"].values())


def finalists(bettered: Sequence[tuple[float, LeastLoad]]) -> list[LeastLoad]:
    """Return of rehearsals that bettered all before them, cost and plan, those that the choice is among, the best last."""
    return [plan for cost, plan in bettered if cost <= DEARER * bettered[-1][0]][-FINALISTS:]
