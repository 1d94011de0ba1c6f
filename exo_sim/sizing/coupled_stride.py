"""One cycle of person, machine, gas and valves for any design, on a model that is built once."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control.valve_control import force_limits
from exo_sim.gait import scenario as scenarios
from exo_sim.gait.motion import look_up
from exo_sim.machine.attachment import attach
from exo_sim.machine.linkage import moment_row
from exo_sim.machine.worn_model import carry
from exo_sim.rig import Rig
from exo_sim.simulation import loop
from exo_sim.simulation.loop_wiring import wire
from exo_sim.simulation.walk import Request, layout
from exo_sim.simulation.worn import Simulation
from exo_sim.sizing.loads import LAW, Condition

#: Time step of the search [s]. Twice that of a run; `tests/sizing` holds the two against each other.
STEP = 2e-3
#: Cycles, and least time [s], of ideal actuators from which every design starts.
_SETTLED, _SETTLED_TIME = 2, 2.0
#: Share of a cycle that a design gets to find its own pressures, before the cycle that counts.
LEAD = 0.5
#: How far the machine may be from its wearer [m].
_LOST = 0.35


@dataclass(frozen=True)
class Stride:
    """What one design did in one condition.

    Attributes:
        gas: Drawn from the supply by all cylinders in the cycle [kg]; over several conditions the mean.
        error: Largest over the joints of the rms of torque less torque demanded [N m].
        worst: That joint.
        peak: Largest pressure in any chamber in the cycle, absolute [Pa].
        most_gas: That of the condition which draws most [kg].
        finished: False where numbers left the range that means anything, or the machine left its wearer.
    """

    gas: float
    error: float
    worst: str
    finished: bool
    peak: float
    most_gas: float = 0.0


class CoupledStride:
    """A condition that designs can be put through, one after another; none leaves a trace for the next.

    Args:
        rig: The owner's machine.
        condition: Scenario, payload, cadence.
        step: Of the simulation [s].
        lead: Cycles before the one that counts.
        joints: Those whose error counts; all that have cylinders when empty.
    """

    def __init__(self, rig: Rig, condition: Condition, step: float = STEP, lead: float = LEAD, joints: tuple[str, ...] = ()):
        rig = condition.worn(rig)
        request = Request(condition.scenario, condition.payload, condition.speed, 1, law=LAW, step=step)
        sim = self._simulation = Simulation(rig, request)
        self.condition, self.dt = condition, sim.dt
        added = scenarios.find(condition.scenario).added
        if added is not None:
            sim.added, sim.demand = None, sim.demand_added
            carry(sim.model, condition.payload + added.mass)
        self._wired = wire(sim)
        self._first, start = self._settle()
        self._start = start
        self._lead = round(lead * sim.motion.period / self.dt)
        self._count = round(sim.motion.period / self.dt)
        keys = [key for key, _ in layout(rig, sim.straps, True)]
        self._log = np.empty((self._lead + self._count, 1 + len(keys)))
        column = {key: i + 1 for i, key in enumerate(keys)}
        self._joints = joints or tuple(dict.fromkeys(link.joint for link in sim.plugin.links))
        self._torque = [column[f"{joint}.torque"] for joint in self._joints]
        self._wanted = [column[f"{joint}.torque_demanded"] for joint in self._joints]
        self._gas = [column[f"{name}.gas_used"] for name in rig.cylinders]
        self._tank = column.get("recovery.gas")
        self._pressures = [column[f"{name}.pressure_{side}"] for name in rig.cylinders for side in (1, 2)]

    @property
    def steps(self) -> int:
        """How many steps one run takes."""
        return len(self._log)

    def _settle(self) -> tuple[int, NDArray[np.float64]]:
        """Walk with ideal actuators; return the number of the step at a cycle's start, and MuJoCo's state there."""
        sim = self._simulation
        cycles = max(_SETTLED, math.ceil(_SETTLED_TIME / sim.motion.period))
        count = round(cycles * sim.motion.period / self.dt)
        log = np.empty((count, 1 + len(layout(sim.rig, sim.straps, False))))
        settings, mechanics, plant, bodies, wearer, drives = self._wired
        loop.run(0, count, settings._replace(kind=loop.IDEAL), mechanics, plant, bodies, wearer, drives, log)
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        state = np.empty(mujoco.mj_stateSize(sim.model, kind))
        mujoco.mj_getState(sim.model, sim.data, state, kind)
        return count, state

    def run(self, rig: Rig) -> Stride:
        """Put a fitted rig through one cycle.

        Args:
            rig: The owner's machine with a design's cylinders (`design.fitted`).
        """
        sim = self._simulation
        attach(sim.model, rig, sim.plugin.links, sim.data)
        mujoco.mj_resetData(sim.model, sim.data)
        mujoco.mj_setState(sim.model, sim.data, self._start, mujoco.mjtState.mjSTATE_INTEGRATION)
        sim.plugin.refit(rig)
        sim.plugin.pneumatics.world["longest_step"] = self.dt  # accuracy to a few parts in ten thousand is enough here
        sim.lay_plans()
        self._wired = (*self._wired[:-1], self._wired[-1]._replace(plan=sim.plan, plan_added=sim.plan_added))
        self._fill(rig)
        loop.run(self._first, len(self._log), *self._wired, self._log)
        return self._judged()

    def _fill(self, rig: Rig) -> None:
        """Fill the chambers so that the rods start with the forces wanted of them, half way between exhaust and supply or as planned."""
        sim, data = self._simulation, self._simulation.data
        mujoco.mj_forward(sim.model, data)
        at = (self._first * self.dt / sim.motion.period) % 1.0
        wanted = sim.demand[round(at * (len(sim.demand) - 1))]
        p_s, p_e, drives = rig.supply.pressure, rig.environment.pressure, self._wired[-1]
        middle = 0.5 * (p_s + p_e)
        pressures = np.empty((2, len(sim.plugin.links)))
        for i, link in enumerate(sim.plugin.links):
            cylinder = rig.cylinders[link.cylinder]
            a_1, a_2 = cylinder.area_1, cylinder.area_2
            arm = float(moment_row(sim.model, data, link.actuator)[link.dof])
            low, high = force_limits(a_1, a_2, p_s, p_e, p_e)
            force = min(max(wanted[link.dof - 3] / arm if abs(arm) > 5e-3 else 0.0, low), high)
            drives.wanted[i] = force
            apart = (force - (middle - p_e) * (a_1 - a_2)) / (a_1 + a_2)
            p_1 = min(max(middle + apart, p_e), p_s)
            p_2 = min(max((p_1 * a_1 - p_e * (a_1 - a_2) - force) / a_2, p_e), p_s)
            p_1 = min(max((force + p_2 * a_2 + p_e * (a_1 - a_2)) / a_1, p_e), p_s)
            pressures[:, i] = p_1, p_2
            if len(sim.plan) and cylinder.valve.independent:
                look_up(at, sim.plan, drives.planned)
                pressures[:, i] = drives.planned[2 * i : 2 * i + 2]
        drives.before[:] = drives.wanted
        drives.integral[:] = 0.0
        sim.plugin.reset(data, *pressures)

    def _judged(self) -> Stride:
        part = self._log[self._lead :]
        names = self._joints
        if not np.isfinite(part).all():
            return Stride(math.inf, math.inf, names[0], False, math.inf)
        cycles = part[:, 0] / self._simulation.motion.period
        away = part[:, 1] - self._simulation.motion.advance * cycles - self._simulation.motion.at(cycles)[:, 0]
        errors = np.sqrt(np.mean((part[:, self._torque] - part[:, self._wanted]) ** 2, axis=0))
        worst = int(np.argmax(errors))
        drawn = float(np.sum(part[-1, self._gas] - part[0, self._gas]))
        if self._tank is not None:  # what the tank lost was bought before, what it gained is there for later
            drawn -= float(part[-1, self._tank] - part[0, self._tank])
        gas = drawn * self._simulation.motion.stride_time / float(part[-1, 0] - part[0, 0])
        near = bool(np.abs(away).max() < _LOST)
        return Stride(gas, float(errors[worst]), names[worst], near, float(part[:, self._pressures].max()))


def mean_of(strides: list[Stride]) -> Stride:
    """Return one for all conditions: the mean of the gas, the worst of the rest."""
    worst = max(strides, key=lambda stride: stride.error)
    return replace(
        worst,
        gas=float(np.mean([stride.gas for stride in strides])),
        most_gas=max(stride.gas for stride in strides),
        finished=all(stride.finished for stride in strides),
        peak=max(stride.peak for stride in strides),
    )
