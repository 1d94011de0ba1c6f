"""All cylinders of one machine with their state: what the plug-in, the diagnosis and the sizing hold in their hands."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics import nodes, plant, state
from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.cylinder import rod_force
from exo_sim.physics.effects import unknown
from exo_sim.physics.records import CYLINDER, JOINT, WORLD
from exo_sim.physics.resistance import joint_dry_level, joint_resistance, move_bristle, piston_resistance
from exo_sim.physics.transmission import carried, gives, piston_at

#: Longest dead time that a valve's history is kept for [s]; the bound of `valve_lag.delay`.
LONGEST_DELAY = 0.1


@inlined_kernel
def rod_forces(world, cylinders, state_vector, x, v, force):
    """Write the force of each rod on the joint's side [N], + pushes out: gas, atmosphere, and what resists the piston.

    Args:
        x, v: Transmission length less the retracted one, and its rate, shape (n,).
        force: Result, shape (n,).
    """
    n = len(cylinders)
    total = n * state.INTEGRATED + state.SHARED
    memory = state_vector[total:]
    for i in range(n):
        c = cylinders[i]
        place = i * state.REMEMBERED
        here = memory[place + state.PISTON] if gives(c) else x[i]
        p_1, p_2 = plant.pressures(world, c, state_vector, i * state.INTEGRATED, here)
        if gives(c):
            z, speed = memory[place + state.BRISTLE], memory[place + state.PISTON_SPEED]
            piston = piston_at(world, c, p_1, p_2, here, x[i], z, speed, 0.0)
            force[i] = carried(c, piston, x[i])
        else:
            g_1, g_2 = p_1 - world.atmosphere, p_2 - world.atmosphere
            push = rod_force(p_1, p_2, c.area_1, c.area_2, world.atmosphere)
            push += unknown.acting(c.unknown, 0, x[i], v[i], p_1, p_2)
            force[i] = push - piston_resistance(c, memory[place + state.BRISTLE], x[i], v[i], g_1, g_2)


@kernel
def sensed_pressures(world, cylinders, state_vector, i: int, x: float) -> tuple[float, float]:
    """Return the absolute pressures that cylinder i's sensors read [Pa], with the joint's side at x.

    The piston may be elsewhere than the joint has it, and the sensors at the valve's end of the hoses.
    """
    c = cylinders[i]
    n = len(cylinders)
    here = state_vector[n * state.INTEGRATED + state.SHARED + i * state.REMEMBERED + state.PISTON] if gives(c) else x
    return nodes.sensed_pressures(world, c, state_vector, i * state.INTEGRATED, here)


@kernel
def joint_forces(joints, bristles, q, qd, force):
    """Write the generalised force that each joint's own friction, spring and drag exert, shape (m,) [N or N m]."""
    for i in range(len(joints)):
        force[i] = -joint_resistance(joints[i], bristles[i], q[i], qd[i])
        force[i] += unknown.acting(joints[i].unknown, 0, q[i], qd[i], 0.0, 0.0)


@kernel
def advance_joints(joints, bristles, q0, q1, dt):
    """Move the bristles of the joints on by a step, from q0 to q1, shape (m,)."""
    for i in range(len(joints)):
        speed = (q1[i] - q0[i]) / dt
        bristles[i] = move_bristle(joints[i], bristles[i], speed, joint_dry_level(joints[i], speed, bristles[i]), dt)


@kernel
def delayed(history, newest, delay, dt):
    """Return the mean over the coming step of a held command that arrives `delay` seconds late.

    Args:
        history: Ring of past commands, one a step, shape (size,).
        newest: Index of the command of this step.
        delay: Seconds.
        dt: Seconds a step.
    """
    steps = delay / dt
    whole = math.floor(steps)
    part = steps - whole
    size = history.size
    late = history[(newest - whole) % size]
    return late if part == 0.0 else (1.0 - part) * late + part * history[(newest - whole - 1) % size]


@inlined_kernel
def step(world, cylinders, joints, vector, history, x0, x1, q0, q1, command, dt, work, scratch):
    """Move everything pneumatic on by one step; `history` holds one ring a cylinder and, last, the index of the newest.

    Args:
        vector: The state vector of `state.py`, joint bristles at its end.
        history: Shape (n, size + 1).
        x0, x1: Transmission lengths less the retracted ones, before and after, shape (n,).
        q0, q1: Positions of the joints that have friction of their own, shape (m,).
        command: Valve commands held over the step, shape (n,).
    """
    late = scratch[5]
    size = history.shape[1] - 1
    for i in range(len(cylinders)):
        held = min(max(command[i], -1.0), 1.0)
        if math.isnan(command[i]):  # a controller's mistake must show
            vector[i * state.INTEGRATED + state.ENERGY_1] = vector[i * state.INTEGRATED + state.ENERGY_2] = command[i]
        if size > 1:
            newest = int(history[i, size] + 1.0) % size
            history[i, size] = newest
            history[i, newest] = held
            held = delayed(history[i, :size], newest, cylinders[i].valve_lag.delay, dt)
        late[i] = held
    plant.advance(world, cylinders, vector, x0, x1, late, dt, work, scratch)
    bristles = vector[vector.size - len(joints) :]
    advance_joints(joints, bristles, q0, q1, dt)


@dataclass
class Books:
    """What went in and out, against what is there now.

    Attributes:
        mass_residual: Gas unaccounted for, relative to what passed through.
        energy_residual: Energy unaccounted for, relative to what passed through.
        drawn: Gas drawn from the supply by each cylinder [kg], shape (n,).
        heat: Heat into the gas of each cylinder [J], shape (n,).
        work: Work of the gas on each piston [J], shape (n,).
    """

    mass_residual: float
    energy_residual: float
    drawn: NDArray[np.float64]
    heat: NDArray[np.float64]
    work: NDArray[np.float64]


class Pneumatics:
    """Cylinders, shared supply and exhaust, friction of joints; their state is `vector` and `history`.

    Args:
        world: Record WORLD, shape (1,).
        cylinders: Records CYLINDER, shape (n,).
        joints: Records JOINT for joints with friction of their own, shape (m,).
        dt: Seconds a step.
    """

    def __init__(
        self,
        world: NDArray[np.void],
        cylinders: NDArray[np.void],
        joints: NDArray[np.void] | None = None,
        dt: float = 1e-3,
    ):
        self.world = world
        self.cylinders = cylinders
        self.joints = np.zeros(0, JOINT) if joints is None else joints
        self.dt = dt
        self.cylinders["step"] = self.joints["step"] = dt
        n = len(cylinders)
        self.vector = np.zeros(state.size(n, len(self.joints)))
        delays = cylinders["valve_lag"]["delay"]
        ring = math.ceil(float(delays.max()) / dt) + 2 if n and delays.max() > 0.0 else 1
        self.history = np.zeros((n, ring + 1))
        self._work = np.zeros((5, state.integrated_size(n)))
        self._scratch = np.zeros((6, n))
        self._start = self.vector.copy()

    @property
    def integrated(self) -> NDArray[np.float64]:
        """The cylinders' integrated states, shape (n, INTEGRATED); a view."""
        n = len(self.cylinders)
        return self.vector[: n * state.INTEGRATED].reshape(n, state.INTEGRATED)

    @property
    def memory(self) -> NDArray[np.float64]:
        """The cylinders' remembered states, shape (n, REMEMBERED); a view."""
        n = len(self.cylinders)
        start = state.integrated_size(n)
        return self.vector[start : start + n * state.REMEMBERED].reshape(n, state.REMEMBERED)

    @property
    def bristles(self) -> NDArray[np.float64]:
        """The joints' bristles, shape (m,); a view."""
        return self.vector[self.vector.size - len(self.joints) :]

    def fill(
        self,
        x: NDArray[np.float64],
        p_1: NDArray[np.float64] | float,
        p_2: NDArray[np.float64] | float,
        temperature: float | None = None,
    ) -> None:
        """Set gas at rest: pressures p_1, p_2 [Pa] (n,) with the pistons at x [m] (n,), ambient unless a temperature is given."""
        world = self.world[0]
        n = len(self.cylinders)
        t = float(world["ambient"]) if temperature is None else temperature
        k, r = float(world["k"]), float(world["r"])
        self.vector[:] = 0.0
        self.history[:] = 0.0
        y, c = self.integrated, self.cylinders
        v_1, v_2 = np.array([plant.volumes(one, at) for one, at in zip(c, np.broadcast_to(x, n))]).reshape(n, 2).T
        p_2 = np.where(c["single_acting"] > 0.0, world["atmosphere"], p_2)
        for p, v, mass, energy in ((p_1, v_1, state.MASS_1, state.ENERGY_1), (p_2, v_2, state.MASS_2, state.ENERGY_2)):
            y[:, mass] = p * v / (r * t)
            y[:, energy] = p * v / (k - 1.0)
        hose = c["line_restriction"]["volume"]
        for p, mass, energy in (
            (p_1, state.HOSE_MASS_1, state.HOSE_ENERGY_1),
            (p_2, state.HOSE_MASS_2, state.HOSE_ENERGY_2),
        ):
            y[:, mass] = p * hose / (r * t)
            y[:, energy] = p * hose / (k - 1.0)
        y[:, state.WALL_1] = y[:, state.WALL_2] = float(world["ambient"])
        self.memory[:, state.PISTON] = x
        shared = self.vector[n * state.INTEGRATED :]
        tank, manifold = float(world["supply_droop"]["volume"]), float(world["exhaust_back_pressure"]["volume"])
        p_s, t_s, p_e = (
            float(world["supply_pressure"]),
            float(world["supply_temperature"]),
            float(world["exhaust_pressure"]),
        )
        shared[state.SUPPLY_MASS] = p_s * tank / (r * t_s)
        shared[state.SUPPLY_ENERGY] = p_s * tank / (k - 1.0)
        shared[state.EXHAUST_MASS] = p_e * manifold / (r * float(world["ambient"]))
        shared[state.EXHAUST_ENERGY] = p_e * manifold / (k - 1.0)
        self._start = self.vector.copy()

    def settle_transmission(self, x: NDArray[np.float64]) -> None:
        """Put each piston where gas and transmission balance with the joints at x, the pressures kept (after `fill`)."""
        world = self.world[0]
        y, memory = self.integrated, self.memory
        for i, c in enumerate(self.cylinders):
            if gives(c):
                p_1, p_2 = plant.pressures(world, c, self.vector, i * state.INTEGRATED, x[i])
                force = rod_force(p_1, p_2, c["area_1"], c["area_2"], world["atmosphere"])
                piston = x[i] + _deflection(c, force)
                before = np.array(plant.volumes(c, x[i]))
                after = np.array(plant.volumes(c, piston))
                y[i, [state.MASS_1, state.MASS_2]] *= after / before
                y[i, [state.ENERGY_1, state.ENERGY_2]] *= after / before
                memory[i, state.PISTON] = piston
        self._start = self.vector.copy()

    def pressures(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return both chamber pressures with the pistons at x, shape (n, 2) [Pa]."""
        at = np.where([gives(c) for c in self.cylinders], self.memory[:, state.PISTON], x)
        return np.array(
            [
                plant.pressures(self.world[0], c, self.vector, i * state.INTEGRATED, at[i])
                for i, c in enumerate(self.cylinders)
            ]
        )

    def sensed_pressures(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the pressures that the sensors read with the joints' sides at x, shape (n, 2) [Pa]."""
        world, n = self.world[0], len(self.cylinders)
        return np.array([sensed_pressures(world, self.cylinders, self.vector, i, x[i]) for i in range(n)])

    def temperatures(self) -> NDArray[np.float64]:
        """Return both gas temperatures, shape (n, 2) [K]."""
        return np.array(
            [plant.temperatures(self.world[0], self.vector, i * state.INTEGRATED) for i in range(len(self.cylinders))]
        )

    def forces(self, x: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the rod forces on the joints' side, shape (n,) [N]."""
        force = np.zeros(len(self.cylinders))
        rod_forces(self.world[0], self.cylinders, self.vector, x, v, force)
        return force

    def advance(
        self,
        x0: NDArray[np.float64],
        x1: NDArray[np.float64],
        command: NDArray[np.float64],
        q0: NDArray[np.float64] | None = None,
        q1: NDArray[np.float64] | None = None,
    ) -> None:
        """Move the state on by `dt` with pistons going from x0 to x1 and valves at `command`, each of shape (n,)."""
        none = np.zeros(0)
        step(
            self.world[0], self.cylinders, self.joints, self.vector, self.history, x0, x1,
            none if q0 is None else q0, none if q1 is None else q1, command, self.dt, self._work, self._scratch,
        )  # fmt: skip

    def books(self) -> Books:
        """Return what passed through since `fill`, and what the books cannot account for."""
        n = len(self.cylinders)
        now, then = self.vector, self._start
        change = (now - then)[: state.integrated_size(n)]
        y, shared = change[: n * state.INTEGRATED].reshape(n, state.INTEGRATED), change[n * state.INTEGRATED :]
        mass = [state.MASS_1, state.MASS_2, state.HOSE_MASS_1, state.HOSE_MASS_2]
        energy = [state.ENERGY_1, state.ENERGY_2, state.HOSE_ENERGY_1, state.HOSE_ENERGY_2]
        missing = y[:, mass].sum(1) - y[:, state.DRAWN] + y[:, state.EXHAUSTED] + y[:, state.LEAKED]
        lost = (
            y[:, energy].sum(1)
            - y[:, state.DRAWN_ENTHALPY]
            + y[:, state.EXHAUSTED_ENTHALPY]
            + y[:, state.LEAKED_ENTHALPY]
        )
        lost += y[:, state.WORK] - y[:, state.HEAT]
        passed = np.abs(y[:, [state.DRAWN, state.EXHAUSTED, state.LEAKED]]).sum()
        carried_energy = np.abs(
            y[:, [state.DRAWN_ENTHALPY, state.EXHAUSTED_ENTHALPY, state.LEAKED_ENTHALPY, state.WORK, state.HEAT]]
        ).sum()
        off, off_energy = np.abs(missing).sum(), np.abs(lost).sum()
        if self.world["supply_droop"]["volume"][0] > 0.0:
            off += abs(shared[state.SUPPLY_MASS] - shared[state.FED] + y[:, state.DRAWN].sum())
            off_energy += abs(
                shared[state.SUPPLY_ENERGY] - shared[state.FED_ENTHALPY] + y[:, state.DRAWN_ENTHALPY].sum()
            )
        if self.world["exhaust_back_pressure"]["area"][0] > 0.0:
            off += abs(shared[state.EXHAUST_MASS] + shared[state.RELEASED] - y[:, state.EXHAUSTED].sum())
            off_energy += abs(
                shared[state.EXHAUST_ENERGY] + shared[state.RELEASED_ENTHALPY] - y[:, state.EXHAUSTED_ENTHALPY].sum()
            )
        return Books(
            float(off / passed) if passed > 0.0 else float(off),
            float(off_energy / carried_energy) if carried_energy > 0.0 else float(off_energy),
            y[:, state.DRAWN].copy(),
            y[:, state.HEAT].copy(),
            y[:, state.WORK].copy(),
        )


def _deflection(c: np.void, force: float) -> float:
    """Return piston less joint under a force that the transmission carries [m]."""
    from exo_sim.physics.transmission import stiffness

    gap = float(c["backlash"]["gap"]) + float(c["drive_gap"]) * abs(float(c["arm"]))
    return force / stiffness(c) + 0.5 * gap * float(np.sign(force))


def paper_world(supply_pressure: float = 7e5) -> NDArray[np.void]:
    """Return dry air at 20 C and one atmosphere, with nothing of the supply or exhaust left out; shape (1,)."""
    world = np.zeros(1, WORLD)
    world["k"], world["r"], world["atmosphere"], world["ambient"] = 1.4, 287.05, 101325.0, 293.15
    world["supply_pressure"], world["supply_temperature"], world["exhaust_pressure"] = supply_pressure, 293.15, 101325.0
    return world


def paper_cylinder(
    bore: float,
    rod: float,
    stroke: float,
    valve_area: float,
    dead_volume_1: float = 0.0,
    dead_volume_2: float = 0.0,
    single_acting: bool = False,
) -> NDArray[np.void]:
    """Return one cylinder without any effect, shape (1,); lengths in m, areas in m^2, volumes in m^3."""
    c = np.zeros(1, CYLINDER)
    c["area_1"] = math.pi / 4 * bore**2
    c["area_2"] = c["area_1"] - math.pi / 4 * rod**2
    c["stroke"], c["valve_area"], c["single_acting"], c["arm"] = stroke, valve_area, float(single_acting), 1.0
    c["dead_volume_1"], c["dead_volume_2"] = dead_volume_1, dead_volume_2
    return c
