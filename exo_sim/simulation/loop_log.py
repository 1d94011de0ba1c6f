"""The row that a step of the loop leaves in the log, in the order of `walk.columns`."""

from __future__ import annotations

import numpy as np

from exo_sim.gait.motion import look_up
from exo_sim.physics.compiled import inlined_kernel, kernel
from exo_sim.physics.forces import sensed_pressures
from exo_sim.physics.nodes import exhaust_state, supply_state, tank_state, temperatures
from exo_sim.physics.nozzle import critical_ratio
from exo_sim.physics.state import DRAWN, HELD, INTEGRATED, REMEMBERED, SHARED, TANK_MASS

#: A force that is shorter [N], or along the sole but for this share, meets the sole at no place to speak of.
PRESSED, ALONG = 1.0, 0.1


@kernel
def _choked(c, u_1, u_2, p_1, p_2, p_s, p_e, critical):
    """Return how many of a valve's open paths are choked."""
    found = 0.0
    if u_1 != 0.0:
        found += 1.0 if (p_1 < critical * p_s if u_1 > 0.0 else p_e < critical * p_1) else 0.0
    if u_2 != 0.0:
        found += 1.0 if (p_2 < critical * p_s if u_2 > 0.0 else p_e < critical * p_2) else 0.0
    return 0.0 if c.vented > 0.0 else found


@inlined_kernel
def log_motion(row, time, mechanics):
    """Write the first columns that `walk.columns` names: time, positions, velocities. MuJoCo's step moves them on."""
    row[0] = time
    for j in range(9):
        row[1 + j], row[10 + j] = mechanics.qpos[j], mechanics.qvel[j]


@inlined_kernel
def _log_powers(row, at, mechanics, plant, bodies, wearer):
    """Write the mean power over the step of whatever works on the machine, in the order of `walk.POWERS`, a strap's over the step before.

    A force that is held over a step does the work of the mean of both speeds; damping acts at the end of it (implicitfast).
    """
    for j in range(7):
        row[at + j] = 0.0
    for j in range(9):
        after = mechanics.qvel[j]
        before = row[10 + j]
        mean = 0.5 * (before + after)
        own = 0.0
        for i in range(len(plant.joints)):
            if plant.dofs[i] == j:
                own = plant.own[i]
        row[at] += bodies.qfrc_constraint[j] * mean
        row[at + 1] += (own - bodies.dof_damping[j] * after) * mean
        row[at + 2] += (bodies.qfrc_passive[j] + bodies.dof_damping[j] * before) * mean
        if j >= 3:
            row[at + 3] += row[16 + j] * mean
    for i in range(wearer.body.size):
        row[at + 4 + wearer.group[i]] += wearer.power[i]


@inlined_kernel
def _pressure_centre(foot, bodies):
    """Return how far ahead of the foot's site, along its body's x axis, the ground's force has no moment about y [m]; 0 in the air.

    A sole that is tilted, or rubbed otherwise at heel and toe, is pushed along a line that misses the middle of its contacts.
    """
    at, site, body = bodies.ground[foot], bodies.sole[foot], bodies.foot[foot]
    wrench = bodies.sensordata
    x, z = wrench[at], wrench[at + 2]
    if z >= 0.0:
        return 0.0
    along, up = bodies.xmat[body, 0], bodies.xmat[body, 6]
    ahead, above = wrench[at + 6] - bodies.site_xpos[site, 0], wrench[at + 8] - bodies.site_xpos[site, 2]
    normal = along * z - up * x
    if abs(normal) < max(PRESSED, ALONG * np.hypot(x, z)):
        return along * ahead + up * above
    return (ahead * z - above * x - wrench[at + 4]) / normal


@inlined_kernel
def log_rest(row, cycles, with_gas, mechanics, plant, bodies, wearer, drives):
    """Write the columns behind the motion, in the order of `walk.columns`; forces on the ground are there after MuJoCo's step."""
    at = 19
    for j in range(6):
        row[at + j], row[at + 6 + j] = 0.0, wearer.torque[j]
    for i in range(plant.actuators.size):
        row[at + plant.driven[i] - 3] += plant.cylinders[i].arm * drives.made[i]
    for j in range(drives.ankles.size):
        if drives.ankles[j] >= 0:
            row[at + 3 * j + 2] += mechanics.ctrl[drives.ankles[j]]
    at += 12
    for i in range(wearer.body.size):
        row[at], row[at + 1] = wearer.force[i, 0], wearer.force[i, 1]
        at += 2
    for foot in range(2):
        sensor = bodies.ground[foot]
        row[at + 2 * foot], row[at + 2 * foot + 1] = -bodies.sensordata[sensor], -bodies.sensordata[sensor + 2]
        row[at + 4 + foot] = _pressure_centre(foot, bodies)
    at += 6
    row[at] = cycles - np.floor(cycles)
    look_up(cycles, wearer.share, wearer.carried)
    row[at + 1], row[at + 2] = wearer.carried[0], wearer.carried[1]
    at += 3
    _log_powers(row, at, mechanics, plant, bodies, wearer)
    at += 7
    for s in range(7):
        for j in range(3):
            row[at] = wearer.wrench[s, j]
            at += 1
    for i in range(plant.actuators.size):
        row[at], row[at + 1] = drives.wanted[i], drives.made[i]
        row[at + 2] = mechanics.actuator_length[plant.actuators[i]] - plant.retracted[i]
        at += 3
    if with_gas:
        w = plant.world[0]
        critical = critical_ratio(w.k)
        shared = plant.actuators.size * INTEGRATED
        held = plant.vector[shared + SHARED + plant.actuators.size * REMEMBERED + HELD]
        p_s, _ = supply_state(w, plant.vector, shared, held)
        p_e, _ = exhaust_state(w, plant.vector, shared)
        for i in range(plant.actuators.size):
            c = plant.cylinders[i]
            p_1, p_2 = sensed_pressures(w, plant.cylinders, plant.vector, i, plant.x[i])
            t_1, t_2 = temperatures(w, plant.vector, i * INTEGRATED)
            u_1 = plant.command[i]
            u_2 = -u_1
            row[at] = u_1
            if c.independent > 0.0:
                u_2 = plant.command[plant.actuators.size + i]
                at += 1
                row[at] = u_2
            row[at + 1], row[at + 2], row[at + 3], row[at + 4] = p_1, p_2, t_1, t_2
            row[at + 5], row[at + 6] = _choked(c, u_1, u_2, p_1, p_2, p_s, p_e, critical), plant.vector[i * INTEGRATED + DRAWN]
            at += 7
        row[at], row[at + 1] = p_s, p_e
        if w.tank_volume > 0.0:
            row[at + 2], row[at + 3] = tank_state(w, plant.vector, shared).p, plant.vector[shared + TANK_MASS]
