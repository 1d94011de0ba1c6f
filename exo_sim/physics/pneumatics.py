"""All cylinders of one machine with their state: what the plug-in, the diagnosis and the sizing hold in their hands."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError
from exo_sim.physics import plant, state
from exo_sim.physics.conservation import Books, balance
from exo_sim.physics.cylinder import rod_force
from exo_sim.physics.effects import line_restriction
from exo_sim.physics.forces import rod_forces, sensed_pressures
from exo_sim.physics.plant import FOLLOWED
from exo_sim.physics.plant_records import CYLINDER, JOINT, WORLD
from exo_sim.physics.refusals import Refusal, unfillable, why
from exo_sim.physics.transmission import gives, stiffness


class Pneumatics:
    """Cylinders, shared supply and exhaust, friction of joints; their state is `vector` and `history`.

    Args:
        world: Record WORLD, shape (1,).
        cylinders: Records CYLINDER, shape (n,).
        joints: Records JOINT for joints with friction of their own, shape (m,).
        dt: Seconds a step.
        names: What errors call the cylinders; their numbers where empty.
        source: What errors name first, such as the rig's file.
    """

    def __init__(
        self,
        world: NDArray[np.void],
        cylinders: NDArray[np.void],
        joints: NDArray[np.void] | None = None,
        dt: float = 1e-3,
        names: Sequence[str] = (),
        source: str = "",
    ):
        self.names, self.source = tuple(names), f"{source}: " if source else ""
        self.world = world
        self.cylinders = cylinders
        self.joints = np.zeros(0, JOINT) if joints is None else joints
        self.dt = dt
        self.cylinders["step"] = self.joints["step"] = dt
        n = len(cylinders)
        self.vector = np.zeros(state.size(n, len(self.joints)))
        delays = cylinders["valve_lag"]["delay"] + np.maximum(cylinders["valve_lag"]["closing_delay"], 0.0)
        ring = math.ceil(float(delays.max()) / dt) + 2 if n and delays.max() > 0.0 else 1
        self.commands = 4 * n if world["tank_volume"][0] > 0.0 else 2 * n if n and cylinders["independent"].any() else n
        self.history = np.zeros((self.commands, ring + 1))
        self._work = np.zeros((5, state.integrated_size(n)))
        self._scratch = np.zeros((6, max(2 * n, self.commands)))
        self.start = self.vector.copy()

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

    def fill(
        self,
        x: NDArray[np.float64],
        p_1: NDArray[np.float64] | float,
        p_2: NDArray[np.float64] | float,
        temperature: float | None = None,
    ) -> None:
        """Set gas at rest: pressures p_1, p_2 [Pa] (n,) with the pistons at x [m] (n,), ambient unless a temperature is given.

        Raises:
            ModelError: a pressure, temperature or position with which no chamber can be filled.
        """
        world = self.world[0]
        n = len(self.cylinders)
        t = float(world["ambient"]) if temperature is None else temperature
        k, r = float(world["k"]), float(world["r"])
        y, c = self.integrated, self.cylinders
        x, p_1 = np.broadcast_to(x, n), np.broadcast_to(p_1, n)
        p_2 = np.where(c["single_acting"] > 0.0, world["atmosphere"], p_2)
        if refusal := unfillable(x, p_1, p_2, np.broadcast_to(t, n)):
            raise self._error(refusal)
        self.vector[:] = 0.0
        self.history[:] = 0.0
        v_1, v_2 = np.array([plant.volumes(one, at) for one, at in zip(c, x)]).reshape(n, 2).T
        for p, v, mass, energy in ((p_1, v_1, state.MASS_1, state.ENERGY_1), (p_2, v_2, state.MASS_2, state.ENERGY_2)):
            y[:, mass] = p * v / (r * t)
            y[:, energy] = p * v / (k - 1.0)
        hoses = c["line_restriction"]
        hose = np.array([line_restriction.node_volume(one) for one in hoses]).reshape(n)
        middle = np.array([line_restriction.middle_volume(one) for one in hoses]).reshape(n)
        for p, v, mass, energy in (
            (p_1, hose, state.HOSE_MASS_1, state.HOSE_ENERGY_1), (p_2, hose, state.HOSE_MASS_2, state.HOSE_ENERGY_2),
            (p_1, middle, state.MIDDLE_MASS_1, state.MIDDLE_ENERGY_1), (p_2, middle, state.MIDDLE_MASS_2, state.MIDDLE_ENERGY_2),
        ):  # fmt: skip
            y[:, mass] = p * v / (r * t)
            y[:, energy] = p * v / (k - 1.0)
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
        recovered = float(world["tank_pressure"]) * float(world["tank_volume"])
        shared[state.TANK_MASS] = recovered / (r * float(world["ambient"]))
        shared[state.TANK_ENERGY] = recovered / (k - 1.0)
        self.start = self.vector.copy()

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
        self.start = self.vector.copy()

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
        """Move the state on by `dt` with pistons going from x0 to x1 (n,) and valves at `command`.

        Commands are of shape (commands,): one a cylinder, and where any has a valve for each chamber those towards chambers 2 behind,
        and where there is a recovery tank those of the paths to it behind these, first all chambers 1.

        Raises:
            ModelError: a command is not a number, or the gas is too fast to be followed; it says what to change.
        """
        none = np.zeros(0)
        code = plant.step(
            self.world[0], self.cylinders, self.joints, self.vector, self.history, x0, x1,
            none if q0 is None else q0, none if q1 is None else q1, command, self.dt, self._work, self._scratch,
        )  # fmt: skip
        if code != FOLLOWED:
            raise self.refused(code, x0, x1, command)

    def refused(self, code: int, x0: NDArray[np.float64], x1: NDArray[np.float64], command: NDArray[np.float64]) -> ModelError:
        """Return the error for a `plant.step` that ended with a code other than `FOLLOWED`; arguments are those of `advance`."""
        return self._error(why(code, self.world, self.cylinders, self.vector, x0, x1, command, self.dt))

    def _error(self, refusal: Refusal) -> ModelError:
        name = self.names[refusal.cylinder] if self.names else f"number {refusal.cylinder + 1}"
        return ModelError(f"{self.source}cylinder {name}: {refusal.says}")

    def books(self) -> Books:
        """Return what passed through since `fill`, and what the books cannot account for."""
        n = len(self.cylinders)
        size = state.integrated_size(n)
        return balance(self.world, n, (self.vector - self.start)[:size], self.start[:size])


def _deflection(c: np.void, force: float) -> float:
    """Return piston less joint under a force that the transmission carries [m]."""
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
