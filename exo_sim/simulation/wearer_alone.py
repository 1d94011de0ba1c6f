"""A torque-driven wearer without the machine: alone, or with a payload as a backpack."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control import wearer_plan, wearer_torques
from exo_sim.control.wearer_plan import Plan
from exo_sim.control.wearer_torques import Mover
from exo_sim.errors import Diverged
from exo_sim.gait.motion import Motion
from exo_sim.gait.moving_body import Moving, trunk
from exo_sim.machine import wearer_body
from exo_sim.machine.person import Person
from exo_sim.machine.wearer_body import Pack
from exo_sim.machine.wearer_moments import backpack_wrench
from exo_sim.simulation import wearer_log, wearer_loop
from exo_sim.simulation.mujoco_calls import address, warnings_counted
from exo_sim.simulation.wearer_log import Moved

Array = NDArray[np.float64]

#: Cycles before the one that is looked at, and how far the pelvis may leave its path before he has fallen [m].
_SETTLING, _FALLEN = 6, 0.35


@dataclass(frozen=True)
class Alone:
    """A walk without the machine.

    Attributes:
        moved: What the wearer did, at every row.
        columns: The log, as `wearer_log.layout` names it.
        step: [s].
        motion: What he went by.
        model: Of MuJoCo.
    """

    moved: Moved
    columns: dict[str, Array]
    step: float
    motion: Motion
    model: mujoco.MjModel

    def last_cycle(self) -> Moved:
        """Return the last whole cycle, at the phases of its motion's samples."""
        n = len(self.motion.position)
        time = np.arange(len(self.moved.toes)) * self.step / self.motion.period
        at = np.floor(time[-1] + 1e-6) - 1.0 + np.arange(n) / n
        return self.moved.at(np.round(at * self.motion.period / self.step).astype(int))


def one_cycle(motion: Motion, person: Person, pack: Pack | None = None, step: float = 0.001) -> Moved:
    """Return one cycle of a walk without the machine, once it repeats itself.

    Args:
        motion: As residual reduction leaves it.
        person: Who walks.
        pack: The payload on the back.
        step: Of the simulation [s].

    Raises:
        Diverged: he falls.
    """
    expected: Array | float = 0.0
    if pack is not None:
        position, acceleration = trunk(Moving.of(motion))
        expected = backpack_wrench(position, acceleration, pack.place, np.full(len(position), pack.mass), pack.inertia)
    return walk_alone(wearer_plan.plan(motion, person, expected), person, pack, _SETTLING + 1, step).last_cycle()


def walk_alone(plan: Plan, person: Person, pack: Pack | None, cycles: int, step: float) -> Alone:
    """Let a wearer walk by his torques for some cycles, without the machine.

    Raises:
        Diverged: he falls, or MuJoCo warns.
    """
    model = wearer_body.alone(person, pack, step)
    where = wearer_body.find(model)
    data = mujoco.MjData(model)
    motion = plan.motion
    stand(data, where.dofs, motion)
    position, slope = motion.tables()
    share = np.ascontiguousarray(np.concatenate([motion.share, motion.share[:1]]))
    mover: Mover = wearer_torques.mover(person, 0.0 if pack is None else pack.mass, plan.torque, where.dofs, plan.room)
    wearer_torques.dampen(model, mover)
    rows = math.ceil(cycles * motion.period / step - 1e-9) + 1
    log = np.empty((rows, wearer_loop.COUNT))
    wrench = np.zeros((7, 3))
    with warnings_counted():
        wearer_loop.run(
            0, rows, step, motion.period, motion.advance, address("mj_step1"), address("mj_step2"), model._address, data._address,
            data.qpos, data.qvel, data.qfrc_applied, data.sensordata, data.qfrc_constraint, data.qfrc_passive, damping(model),
            position, slope, share, person.lengths(), where.ground, np.zeros(9), np.zeros(9), np.zeros((7, 6)), wrench, mover, log,
        )  # fmt: skip
    wanted = motion.at(np.arange(rows, dtype=np.float64) * (step / motion.period), 2)
    if not np.isfinite(log).all() or np.abs(log[:, 1] - wanted[:, 1]).max() > _FALLEN:
        advice = "walk nearer to the recorded cadence, or with less payload"
        raise Diverged(f"the wearer falls within {cycles} strides without the machine; {advice}")
    columns = {key: column for (key, _), column in zip(wearer_log.layout(), np.ascontiguousarray(log.T))}
    it = wearer_log.moved(columns, np.zeros((rows, 7, 3)), person)
    return Alone(it, columns, step, motion, model)


def stand(data: mujoco.MjData, dofs: NDArray[np.int64], motion: Motion) -> None:
    """Put the wearer where the motion begins, moving with it."""
    data.qpos[dofs[:9]] = motion.position[0]
    data.qvel[dofs[:9]] = motion.slope[0] / motion.period


def damping(model: mujoco.MjModel) -> Array:
    """Return the linear damping of each degree of freedom, shape (nv,)."""
    of_dofs = model.dof_damping
    return np.ascontiguousarray(of_dofs if of_dofs.ndim == 1 else of_dofs[:, 0])
