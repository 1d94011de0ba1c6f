"""One step of person, straps, demand, valves, gas and MuJoCo, and the compiled loop over it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.valve_control import MODEL, PI, force_limits, invert, pi
from exo_sim.gait.motion import Motion, look_up, reference
from exo_sim.machine.person import Person, pose_bodies, segment_poses
from exo_sim.machine.straps import pull
from exo_sim.physics import plant
from exo_sim.physics.compiled import borrow, kernel
from exo_sim.physics.gas import critical_ratio
from exo_sim.physics.nodes import exhaust_state, supply_state
from exo_sim.physics.pneumatics import sensed_pressures
from exo_sim.physics.state import DRAWN, HELD, INTEGRATED, REMEMBERED, SHARED
from exo_sim.simulation.coupling import advance_gas, compute_forces, moment_arm
from exo_sim.simulation.native import call

Array = NDArray[np.float64]
Index = NDArray[np.int64]

IDEAL, GAS = 0, 1
#: Rows of `Settings.numbers`.
PERIOD, ADVANCE, PREVIEW, RAMP, ADDED, ADDED_AT, ADDED_OVER, PAYLOAD, CLOSING, PROPORTIONAL, INTEGRAL, DT = range(12)


class Addresses(NamedTuple):
    """Of MuJoCo's functions and of model and data."""

    step1: int
    step2: int
    model: int
    data: int


class World(NamedTuple):
    """Views into MuJoCo's data and model."""

    qpos: Array
    qvel: Array
    xpos: Array
    xmat: Array
    xipos: Array
    cvel: Array
    subtree_com: Array
    mocap_pos: Array
    mocap_quat: Array
    ctrl: Array
    xfrc_applied: Array
    qfrc_applied: Array
    actuator_length: Array
    actuator_velocity: Array
    actuator_moment: Array
    moment_rownnz: NDArray[np.int32]
    moment_rowadr: NDArray[np.int32]
    moment_colind: NDArray[np.int32]
    sensordata: Array
    body_mass: Array
    body_inertia: Array
    body_subtreemass: Array


class Wearer(NamedTuple):
    """Person, straps and demand."""

    position: Array
    slope: Array
    lengths: Array
    offset_y: Array
    demand: Array
    demand_added: Array
    share: Array
    body: Index
    local: Array
    segment: Index
    anchor: Array
    stiffness: Array
    damping: Array
    q: Array
    v: Array
    poses: Array
    force: Array
    wrench: Array
    torque: Array
    other: Array
    carried: Array


class Drives(NamedTuple):
    """Cylinders, ankle motors, and what their controllers remember."""

    actuators: Index
    dofs: Index
    ankles: Index
    retracted: Array
    command: Array
    wanted: Array
    before: Array
    integral: Array
    made: Array
    arm: Array


class Gas(NamedTuple):
    """The plant, as `simulation.plugin` holds it."""

    world: NDArray[np.void]
    cylinders: NDArray[np.void]
    joints: NDArray[np.void]
    vector: Array
    history: Array
    x: Array
    x1: Array
    v: Array
    force: Array
    q: Array
    q1: Array
    qd: Array
    own: Array
    felt: Array
    dofs: Index
    addresses: Index
    work: Array
    scratch: Array


class Settings(NamedTuple):
    """What kind of run: the numbers of `PERIOD` to `DT`, and which parts are on."""

    numbers: Array
    kind: int
    controller: int
    root: int
    payload_body: int


@kernel
def _load_payload(fraction, settings, world):
    """Let part of the added mass hang on the frame: mass, inertia in proportion, and the sums that MuJoCo keeps."""
    n, body = settings.numbers, settings.payload_body
    mass = n[PAYLOAD] + fraction * n[ADDED]
    grown = mass / world.body_mass[body]
    change = mass - world.body_mass[body]
    for j in range(3):
        world.body_inertia[body, j] *= grown
    world.body_mass[body] = mass
    world.body_subtreemass[body] += change
    world.body_subtreemass[settings.root] += change
    world.body_subtreemass[0] += change


@kernel
def _ask(cycles, time, fraction, settings, world, wearer, drives, gas):
    """From the phase to the force wanted of each rod, within what its cylinder can hold, and the ankles' torque."""
    n = settings.numbers
    ahead = cycles + n[PREVIEW] / n[PERIOD]
    look_up(ahead, wearer.demand, wearer.torque)
    if n[ADDED] > 0.0:
        look_up(ahead, wearer.demand_added, wearer.other)
        for j in range(6):
            wearer.torque[j] += fraction * (wearer.other[j] - wearer.torque[j])
    if time < n[RAMP]:
        for j in range(6):
            wearer.torque[j] *= time / n[RAMP]
    for i in range(drives.actuators.size):
        a, dof = drives.actuators[i], drives.dofs[i]
        arm = moment_arm(a, dof, world.actuator_moment, world.moment_rownnz, world.moment_rowadr, world.moment_colind)
        gas.cylinders[i].arm = arm
        c = gas.cylinders[i]
        w = gas.world[0]
        low, high = force_limits(c.area_1, c.area_2, w.supply_pressure, w.exhaust_pressure, w.atmosphere)
        drives.arm[i] = arm
        drives.before[i] = drives.wanted[i]
        drives.wanted[i] = min(max(wearer.torque[dof - 3] / arm if abs(arm) > 5e-3 else 0.0, low), high)
    for j in range(drives.ankles.size):
        if drives.ankles[j] >= 0:
            world.ctrl[drives.ankles[j]] = wearer.torque[3 * j + 2]


@kernel
def _open_valves(first, settings, world, drives, gas):
    """From the force wanted to the command of each valve."""
    n = settings.numbers
    for i in range(drives.actuators.size):
        c, w = gas.cylinders[i], gas.world[0]
        x = gas.x[i]
        v = world.actuator_velocity[drives.actuators[i]]
        p_1, p_2 = sensed_pressures(w, gas.cylinders, gas.vector, i, x)
        force = p_1 * c.area_1 - p_2 * c.area_2 - w.atmosphere * (c.area_1 - c.area_2)
        error = drives.wanted[i] - force
        if settings.controller == PI:
            scale = (w.supply_pressure - w.atmosphere) * c.area_1
            drives.command[i], drives.integral[i] = pi(
                error, scale, drives.integral[i], n[PROPORTIONAL], n[INTEGRAL], n[DT]
            )
        elif settings.controller == MODEL:
            t_1, t_2 = plant.temperatures(w, gas.vector, i * INTEGRATED)
            v_1, v_2 = plant.volumes(c, x)
            rate = 0.0 if first else (drives.wanted[i] - drives.before[i]) / n[DT]
            opening = invert(
                rate + error / n[CLOSING], v, p_1, t_1, p_2, t_2, v_1, v_2, c.area_1, c.area_2, c.valve_area,
                w.supply_pressure, w.supply_temperature, w.exhaust_pressure, w.ambient, w.k, w.r,
            )  # fmt: skip
            drives.command[i] = min(max(opening, -1.0), 1.0)
        else:
            drives.command[i] = 0.0


@kernel
def _log_motion(row, time, world):
    """Write the first columns that `walk.columns` names: time, positions, velocities. MuJoCo's step moves them on."""
    row[0] = time
    for j in range(9):
        row[1 + j], row[10 + j] = world.qpos[j], world.qvel[j]


@kernel
def _log(row, cycles, settings, world, wearer, drives, gas):
    """Write the columns behind the motion, in the order of `walk.columns`; forces on the ground are there after MuJoCo's step."""
    at = 19
    for j in range(6):
        row[at + j], row[at + 6 + j] = 0.0, wearer.torque[j]
    for i in range(drives.actuators.size):
        row[at + drives.dofs[i] - 3] += drives.arm[i] * drives.made[i]
    for j in range(drives.ankles.size):
        if drives.ankles[j] >= 0:
            row[at + 3 * j + 2] += world.ctrl[drives.ankles[j]]
    at += 12
    for i in range(wearer.body.size):
        row[at], row[at + 1] = wearer.force[i, 0], wearer.force[i, 1]
        at += 2
    for foot in range(2):
        row[at], row[at + 1] = -world.sensordata[6 * foot], -world.sensordata[6 * foot + 2]
        at += 2
    row[at] = cycles - np.floor(cycles)
    look_up(cycles, wearer.share, wearer.carried)
    row[at + 1], row[at + 2] = wearer.carried[0], wearer.carried[1]
    at += 3
    for s in range(7):
        for j in range(3):
            row[at] = wearer.wrench[s, j]
            at += 1
    for i in range(drives.actuators.size):
        row[at], row[at + 1] = drives.wanted[i], drives.made[i]
        row[at + 2] = world.actuator_length[drives.actuators[i]] - drives.retracted[i]
        at += 3
    if settings.kind == GAS:
        w = gas.world[0]
        critical = critical_ratio(w.k)
        shared = drives.actuators.size * INTEGRATED
        held = gas.vector[shared + SHARED + drives.actuators.size * REMEMBERED + HELD]
        p_s, _ = supply_state(w, gas.vector, shared, held)
        p_e, _ = exhaust_state(w, gas.vector, shared)
        for i in range(drives.actuators.size):
            c = gas.cylinders[i]
            p_1, p_2 = sensed_pressures(w, gas.cylinders, gas.vector, i, gas.x[i])
            t_1, t_2 = plant.temperatures(w, gas.vector, i * INTEGRATED)
            u = drives.command[i]
            filled, emptied = (p_1, p_2) if u > 0.0 else (p_2, p_1)
            choked = 0.0
            if u != 0.0 and c.vented == 0.0:
                choked += 1.0 if filled < critical * p_s else 0.0
                choked += 1.0 if p_e < critical * emptied else 0.0
            row[at], row[at + 1], row[at + 2], row[at + 3], row[at + 4] = u, p_1, p_2, t_1, t_2
            row[at + 5], row[at + 6] = choked, gas.vector[i * INTEGRATED + DRAWN]
            at += 7
        row[at], row[at + 1] = p_s, p_e


@kernel
def run(first, count, addresses, settings, world, wearer, drives, gas, log):
    """Take `count` steps, the first of the run being number 0; row i of `log` is what step first + i began with.

    Order: positions of now; gas up to now; person, straps, demand and valves at now; rod forces; MuJoCo's step.
    """
    settings, world, wearer, drives, gas = borrow(settings), borrow(world), borrow(wearer), borrow(drives), borrow(gas)
    n = settings.numbers
    dt = n[DT]
    for k in range(first, first + count):
        call(addresses.step1, addresses.model, addresses.data)
        time = k * dt
        cycles = time / n[PERIOD]
        if settings.kind == GAS and k > 0:
            advance_gas(
                gas.world[0], gas.cylinders, gas.joints, gas.vector, gas.history, drives.actuators, drives.retracted,
                world.actuator_length, gas.addresses, world.qpos, drives.command, dt, gas.x, gas.x1, gas.q, gas.q1,
                gas.work, gas.scratch,
            )  # fmt: skip
        fraction = 0.0
        if n[ADDED] > 0.0:
            fraction = min(max((time - n[ADDED_AT]) / n[ADDED_OVER], 0.0), 1.0)
            _load_payload(fraction, settings, world)
        reference(cycles, n[PERIOD], n[ADVANCE], wearer.position, wearer.slope, wearer.q, wearer.v)
        segment_poses(wearer.q, wearer.v, wearer.lengths, wearer.poses)
        pose_bodies(wearer.poses, wearer.offset_y, world.mocap_pos, world.mocap_quat)
        pull(
            wearer.poses, world.xpos, world.xmat, world.xipos, world.cvel, world.subtree_com[settings.root],
            wearer.body, wearer.local, wearer.segment, wearer.anchor, wearer.stiffness, wearer.damping,
            world.xfrc_applied, wearer.force, wearer.wrench,
        )  # fmt: skip
        _ask(cycles, time, fraction, settings, world, wearer, drives, gas)
        if settings.kind == GAS:
            _open_valves(k == 0, settings, world, drives, gas)
            compute_forces(
                gas.world[0], gas.cylinders, gas.joints, gas.vector, drives.actuators, drives.retracted,
                world.actuator_length, world.actuator_velocity, gas.dofs, gas.addresses, world.qpos, world.qvel,
                world.ctrl, world.qfrc_applied, gas.x, gas.v, gas.force, gas.q, gas.qd, gas.own, gas.felt,
            )  # fmt: skip
        else:
            for i in range(drives.actuators.size):
                world.ctrl[drives.actuators[i]] = drives.wanted[i]
        for i in range(drives.actuators.size):
            drives.made[i] = world.ctrl[drives.actuators[i]]
        _log_motion(log[k - first], time, world)
        call(addresses.step2, addresses.model, addresses.data)
        _log(log[k - first], cycles, settings, world, wearer, drives, gas)


@kernel
def _segments_along(cycles, period, advance, position, slope, lengths, q, v, out):
    for i in range(cycles.size):
        reference(cycles[i], period, advance, position, slope, q, v)
        segment_poses(q, v, lengths, out[i])


def person_along(time: Array, motion: Motion, person: Person) -> Array:
    """Return the person's segments at some times [s], shape (n, 7, 6), as the loop has them."""
    position, slope = motion.tables()
    out = np.empty((len(time), 7, 6))
    _segments_along(
        time / motion.period, motion.period, motion.advance, position, slope, person.lengths(), np.empty(9),
        np.empty(9), out,
    )  # fmt: skip
    return out
