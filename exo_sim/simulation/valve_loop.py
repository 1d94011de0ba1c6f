"""From the rod force wanted to the command of each valve, in the compiled loop of a worn machine."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.force_signals import Gauges, seen
from exo_sim.control.metering import follow, meter
from exo_sim.control.valve_control import GIVEN, MODEL, PI, invert, pi, spring_pull
from exo_sim.gait.motion import look_up
from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.forces import sensed_pressures
from exo_sim.physics.nodes import tank_state, temperatures, volumes
from exo_sim.physics.state import INTEGRATED

Array = NDArray[np.float64]
Index = NDArray[np.int64]

#: Columns of `Drives.gains`.
CLOSING, PROPORTIONAL, INTEGRAL = range(3)


class Drives(NamedTuple):
    """Ankle motors, what the controllers of the cylinders remember, and what a controller from outside commands or asks for.

    `plan` and `plan_added` are planned pressures over the phase, both chambers of each cylinder, shape (m + 1, 2 n), no rows where there
    is no plan; `planned` and `planned_before` are those of this step and of the one before. `gains` are those of each cylinder, in the
    columns `CLOSING`, `PROPORTIONAL` and `INTEGRAL`; `gauges` what its loop goes by.
    """

    ankles: Index
    wanted: Array
    before: Array
    integral: Array
    made: Array
    commands: Array
    torques: Array
    plan: Array
    plan_added: Array
    planned: Array
    planned_before: Array
    planned_added: Array
    gains: Array
    gauges: Gauges


@inlined_kernel
def look_ahead(cycles, ramp, grows, fraction, plant, drives):
    """Write the planned pressures of this step; with less demand at the start they are nearer to the exhaust's.

    Args:
        cycles: Time in cycles.
        ramp: Share of the demand that is asked for, 1 once the start is over.
        grows: Whether mass is put on the back on the way, and `fraction` of it is there.
        plant, drives: As the loop has them.
    """
    w = plant.world[0]
    drives.planned_before[:] = drives.planned
    look_up(cycles, drives.plan, drives.planned)
    if grows:
        look_up(cycles, drives.plan_added, drives.planned_added)
        for j in range(drives.planned.size):
            drives.planned[j] += fraction * (drives.planned_added[j] - drives.planned[j])
    if ramp < 1.0:
        for j in range(drives.planned.size):
            drives.planned[j] = w.exhaust_pressure + ramp * (drives.planned[j] - w.exhaust_pressure)


@inlined_kernel
def open_valves(step, first, dt, controller, mechanics, plant, drives):
    """Write the command of each valve for the force wanted of its rod.

    Args:
        step: Of the run.
        first: Whether nothing was wanted before.
        dt: Length of a step [s].
        controller: `PI`, `MODEL`, `GIVEN`, or closed valves.
        mechanics, plant, drives: As the loop has them.
    """
    measured = drives.gauges.noise.shape[0] > 0
    for i in range(plant.actuators.size):
        c, w = plant.cylinders[i], plant.world[0]
        x = plant.x[i]
        v = mechanics.actuator_velocity[plant.actuators[i]]
        p_1, p_2 = sensed_pressures(w, plant.cylinders, plant.vector, i, x)
        if measured:
            p_1, p_2, x, v = seen(i, step, dt, mechanics.qpos[plant.driven[i]], c.arm, x, p_1, p_2, drives.gauges)
        force = p_1 * c.area_1 - p_2 * c.area_2 - w.atmosphere * (c.area_1 - c.area_2)
        wanted = drives.wanted[i] + spring_pull(c, x)  # of the gas
        error = wanted - force
        closing = drives.gains[i, CLOSING]
        if controller == PI:
            scale = (w.supply_pressure - w.atmosphere) * c.area_1
            plant.command[i], drives.integral[i] = pi(
                error, scale, drives.integral[i], drives.gains[i, PROPORTIONAL], drives.gains[i, INTEGRAL], dt
            )
            if c.independent > 0.0:  # the chamber that does not push is let off
                pushes = wanted >= 0.0 or c.single_acting > 0.0
                plant.command[plant.actuators.size + i] = -1.0 if pushes else -plant.command[i]
                plant.command[i] = plant.command[i] if pushes else -1.0
        elif controller == MODEL:
            t_1, t_2 = temperatures(w, plant.vector, i * INTEGRATED)
            if measured:
                t_1 = t_2 = w.supply_temperature
            v_1, v_2 = volumes(c, x)
            rate = 0.0 if first else (drives.wanted[i] - drives.before[i]) / dt + c.return_spring.stiffness * v
            if c.independent > 0.0 and c.single_acting == 0.0 and drives.plan.shape[0] > 1:
                ref_1, ref_2 = drives.planned[2 * i], drives.planned[2 * i + 1]
                rate_1 = 0.0 if first else (ref_1 - drives.planned_before[2 * i]) / dt
                rate_2 = 0.0 if first else (ref_2 - drives.planned_before[2 * i + 1]) / dt
                p_t = t_t = 0.0
                if w.tank_volume > 0.0:
                    p_t, t_t = tank_state(w, plant.vector, plant.actuators.size * INTEGRATED)
                u_1, u_2, w_1, w_2 = follow(
                    c, rate + error / closing, v, ref_1, rate_1, ref_2, rate_2, p_1, t_1, p_2, t_2, v_1, v_2, w.supply_pressure,
                    w.supply_temperature, w.exhaust_pressure, w.ambient, p_t, t_t, w.tank_pressure, w.k, w.r,
                )  # fmt: skip
                plant.command[i], plant.command[plant.actuators.size + i] = u_1, u_2
                if w.tank_volume > 0.0:
                    plant.command[2 * plant.actuators.size + i], plant.command[3 * plant.actuators.size + i] = w_1, w_2
                continue
            if c.independent > 0.0:
                plant.command[i], plant.command[plant.actuators.size + i] = meter(
                    c, wanted, rate + error / closing, v, p_1, t_1, p_2, t_2, v_1, v_2, w.supply_pressure,
                    w.supply_temperature, w.exhaust_pressure, w.ambient, w.k, w.r,
                )  # fmt: skip
                continue
            opening = invert(
                rate + error / closing, v, p_1, t_1, p_2, t_2, v_1, v_2, c.area_1, c.area_2, c.valve_area,
                w.supply_pressure, w.supply_temperature, w.exhaust_pressure, w.ambient, w.k, w.r,
            )  # fmt: skip
            plant.command[i] = min(max(opening, -1.0), 1.0)
        elif controller == GIVEN:
            plant.command[i] = min(max(drives.commands[i], -1.0), 1.0)
            if c.independent > 0.0:
                plant.command[plant.actuators.size + i] = min(max(drives.commands[plant.actuators.size + i], -1.0), 1.0)
        else:
            plant.command[i] = 0.0
            if c.independent > 0.0:
                plant.command[plant.actuators.size + i] = 0.0
