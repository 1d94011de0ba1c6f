"""The joint torques that a worn machine is asked for over a cycle: those of a law, bettered by walking a few cycles with them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.control import demand as law_of_demand
from exo_sim.control import machine_dynamics
from exo_sim.control.causal import Calibration
from exo_sim.control.least_load import LeastLoad
from exo_sim.control.load_weights import CALM, FROM_REST, IN_PLACE, QUICK, SMOOTH, SPARING, THOUGHT, Weights
from exo_sim.errors import Diverged
from exo_sim.kept_solutions import kept
from exo_sim.machine.worn_model import PAYLOAD_LIMIT, carry
from exo_sim.simulation.causal_calibration import calibrated
from exo_sim.simulation.demand_choice import Choice, finalists
from exo_sim.simulation.linearised_walk import linearised
from exo_sim.simulation.rehearsal import Rehearsals, steps_alike
from exo_sim.simulation.rehearsed_before import identity
from exo_sim.simulation.torque_limits import too_weak, torque_limits

if TYPE_CHECKING:
    from exo_sim.simulation.worn import Simulation

#: A rehearsal looks at so much time [s] after it has settled.
LOOKED_AT = 1.5
#: Each of two starts has a rehearsal of so many.
_SHARE_OF_A_START = 4


class Demand(NamedTuple):
    """Torques over the cycle, the first row repeated behind the last, shape (n + 1, 6) [N m]; and what is to be said."""

    torque: NDArray[np.float64]
    remarks: tuple[str, ...]


def rehearsed_demand(it: Simulation, payload: float) -> Demand:
    """Return the demand over the cycle for a payload [kg].

    Args:
        it: Walks the rehearsals, and is as before after them; where its law is causal, it has got a calibration.
        payload: On the back.
    """
    request = it.request
    if request.assist != "on" or request.driven:
        return Demand(np.zeros((len(it.motion.position) + 1, 6)), it.remarks)
    model = it.model
    if payload != request.payload:
        model = it.built(min(payload, PAYLOAD_LIMIT))
        carry(model, payload)
    dynamics = machine_dynamics.along(model, it.motion, it.person, it.straps)
    limits = torque_limits(it.plugin, it.motion)
    needed = law_of_demand.demand("inverse_dynamics", dynamics, it.motion, it.straps, it.rig.ankle)
    remarks = () if request.ideal else too_weak(it.plugin.links, payload, needed[machine_dynamics.PICK], limits)
    if request.law not in ("least_load", "causal"):
        return Demand(_closed(law_of_demand.demand(request.law, dynamics, it.motion, it.straps, it.rig.ankle)), remarks)
    weights = request.weights or _weights(it)
    if request.law == "causal" and request.weights is None:
        weights = _weights_where_felt(it)

    def rehearsed() -> NDArray[np.float64]:
        plan = LeastLoad(dynamics, it.motion, it.person, it.straps, it.rig.ankle, limits, weights)
        return _rehearsed(it, plan, needed[machine_dynamics.PICK], payload)

    if request.law == "least_load":  # nobody asks for a calibration
        return Demand(_closed(kept(identity(it, model, payload), rehearsed)), remarks)
    return Demand(_closed(rehearsed()), remarks)


def _weights(it: Simulation) -> Weights:
    """Return what counts where nobody said it."""
    yields = it.request.moved_by == "torques"
    if yields and it.motion.from_rest:
        return CALM
    if yields:
        return SMOOTH
    if it.motion.from_rest:
        return FROM_REST
    if it.motion.advance == 0.0:
        return IN_PLACE
    return SPARING if it.plans_chambers else Weights()


def _weights_where_felt(it: Simulation) -> Weights:
    """Return what counts in the demand of a causal controller where nobody said it."""
    if not steps_alike(it.request, it.motion):
        return replace(THOUGHT, smoothness=QUICK.smoothness)
    return SPARING if it.plans_chambers else QUICK


def _rehearsed(
    it: Simulation, plan: LeastLoad, otherwise: NDArray[np.float64], payload: float
) -> NDArray[np.float64]:
    """Walk a few cycles at a time and better the plan after each time; return the best of the torques tried.

    Two starts have a share of the rehearsals each: torques that are handed in, shape (n, 6) [N m], and the plan's. Those that are left go
    on with the better. One rehearsal alone cannot say which that is. For a causal controller all go on from the plan: demands rehearsed
    from inverse dynamics cost as little as calibrated, and some of them more on straps that are otherwise. Which of the last it gets is
    chosen where something is otherwise (`demand_choice.py`).
    """
    settling, most = it.settling, it.request.rehearsals
    usual = it.demand
    with _few_cycles(it):
        try:
            if payload != it.request.payload:
                carry(it.model, payload)
            best = Rehearsals(plan, settling)
            if most > 1 and it.request.law != "causal":
                share = max(1, most // _SHARE_OF_A_START)
                best = _better(it, [Rehearsals(plan.begun_with(otherwise), settling), best], share)
                most -= 2 * share
            _rehearse(it, best, most)
            plan = best.plan
            if it.request.law == "causal":
                it.calibration = _calibration(it, best)
                plan = it.calibration.plan
        finally:
            it.demand = usual
            carry(it.model, it.request.payload)
    return law_of_demand.limit(plan.torque(best=it.request.rehearsals > 0), it.rig.ankle)


def _calibration(it: Simulation, rehearsals: Rehearsals) -> Calibration:
    """Return what a causal controller begins with: of the best rehearsal, or, where they go by the answer along the walk, chosen."""

    def of(plan: LeastLoad) -> Calibration:
        it.demand = it.demand_added = _closed(law_of_demand.limit(plan.torque(best=True), it.rig.ankle))
        it.reset()
        walk = it.run()
        return calibrated(plan if plan.response is not None else plan.answering(linearised(walk, plan.driven)), walk, it.settling)

    if not steps_alike(it.request, it.motion) or not rehearsals.bettered:
        return of(rehearsals.plan)
    return Choice(it).of(finalists(rehearsals.bettered), of)


def _better(it: Simulation, starts: list[Rehearsals], each: int) -> Rehearsals:
    """Walk so many rehearsals of each start; return those that cost least in one.

    Raises:
        Diverged: the wearer fell in the first rehearsal of all.
    """
    fell: Diverged | None = None
    for one in starts:
        try:
            _rehearse(it, one, each)
        except Diverged as error:
            fell = error
    best = min(starts, key=lambda one: one.least)
    if fell is not None and math.isinf(best.least):
        raise fell
    return best


def _rehearse(it: Simulation, rehearsals: Rehearsals, most: int) -> None:
    """Walk so many rehearsals, or until they are settled; where the wearer falls in one the next goes less far."""
    for _ in range(most):
        it.demand = it.demand_added = _closed(law_of_demand.limit(rehearsals.plan.torque(), it.rig.ankle))
        it.lay_plans()
        it.reset()
        try:
            rehearsals.learn_from(it.run())
        except Diverged:
            if not rehearsals.plan.fell():
                raise
        if rehearsals.settled:
            break


@contextmanager
def _few_cycles(it: Simulation) -> Iterator[None]:
    """Let a simulation be as long as a rehearsal, without what is put on the back on the way."""
    usual = it.added, it.cycles
    it.added, it.cycles = None, it.settling + max(1, math.ceil(LOOKED_AT / it.motion.period))
    try:
        yield
    finally:
        it.added, it.cycles = usual


def _closed(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a table with its first row repeated behind the last."""
    return np.ascontiguousarray(np.concatenate([table, table[:1]]))
