"""Strides that are not those a demand was rehearsed for: what a design must stand beside other wearers and payloads.

The demand and the plan of both pressures are those of the undisturbed walk; what is disturbed is not known to the controller.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait import scenario as scenarios
from exo_sim.gait.variation import Variation
from exo_sim.machine.worn_model import PAYLOAD_LIMIT
from exo_sim.rig import Rig
from exo_sim.simulation import pressure_plans
from exo_sim.simulation.walk import Request
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.loads import Condition


@dataclass(frozen=True)
class Disturbance:
    """One change that the controller does not know of.

    Attributes:
        name: What to call it.
        late: How late the demand comes, in strides.
        stiffness: Of the straps, as a factor; damping grows with its root.
        payload: More than was rehearsed with [kg].
        variation: Of the strides.
    """

    name: str
    late: float = 0.0
    stiffness: float = 1.0
    payload: float = 0.0
    variation: Variation | None = None


#: Timing of 3 % of a stride, as a clock of heel strikes misses it; stride time as healthy adults vary it (`gait.variation`); a trunk that
#: leans, looser straps and a bottle of water more are of the size that docs/walking.md tries the controllers with.
DISTURBANCES = (
    Disturbance("demand 3 % of a stride late", late=0.03),
    Disturbance("demand 3 % of a stride early", late=-0.03),
    Disturbance("straps half as stiff", stiffness=0.5),
    Disturbance("payload 4 kg more than known", payload=4.0),
    Disturbance("hips 3 degrees more flexed", variation=Variation(lean=math.radians(3.0))),
    Disturbance("stride time varies by 2 %", variation=Variation(stride_time=0.02, seed=1)),
)


def disturbances_of(condition: Condition) -> tuple[Disturbance, ...]:
    """Return those that a condition can have: none where nobody walks, no payload beyond what the frame carries."""
    if scenarios.find(condition.scenario).gait is None:
        return ()
    return tuple(one for one in DISTURBANCES if condition.payload + one.payload <= PAYLOAD_LIMIT)


def disturbed(nominal: Simulation, rig: Rig, condition: Condition) -> Iterator[tuple[Disturbance, Simulation]]:
    """Yield a walk for each disturbance, with the demand and the plan of the undisturbed one.

    Args:
        nominal: The walk that was rehearsed.
        rig: Its machine.
        condition: What it does.
    """
    for one in disturbances_of(condition):
        request = Request(
            condition.scenario, condition.payload + one.payload, condition.speed, nominal.request.cycles, law="inverse_dynamics",
            variation=one.variation,
        )  # fmt: skip
        other = Simulation(condition.worn(rig), request)
        other.straps = other.straps.stiffened(one.stiffness)
        demand, plan = late(nominal.demand, one.late), late(nominal.plan, one.late)
        if other.motion.trial is not None:
            demand, plan = other.motion.trial.played(demand), pressure_plans.played(plan, other.motion.trial, other.plugin)
        other.demand = other.demand_added = demand
        other.plan = other.plan_added = plan
        yield one, other


def late(table: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Return a cycle's table, its first row repeated behind the last, so much of the cycle later."""
    if len(table) == 0 or share == 0.0:
        return table
    shifted = np.roll(table[:-1], round(share * (len(table) - 1)), axis=0)
    return np.concatenate([shifted, shifted[:1]])
