"""One step of person, straps, demand, valves, gas and MuJoCo, and the compiled loop over it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.control import wearer_torques
from exo_sim.control.valve_control import force_limits, spring_pull
from exo_sim.control.wearer_torques import Mover
from exo_sim.gait.motion import Motion, look_up, reference
from exo_sim.machine.person import Person, pose_bodies, segment_poses
from exo_sim.machine.straps import pull
from exo_sim.physics.compiled import borrow, inlined_kernel, kernel
from exo_sim.physics.plant import FOLLOWED
from exo_sim.simulation import wearer_loop
from exo_sim.simulation.coupled_step import advance_gas, compute_forces, moment_arm
from exo_sim.simulation.loop_log import log_motion, log_rest
from exo_sim.simulation.mujoco_calls import call
from exo_sim.simulation.valve_loop import look_ahead, open_valves

Array = NDArray[np.float64]
Index = NDArray[np.int64]

IDEAL, GAS = 0, 1
#: Where the joint torques asked for come from: tables over the phase, or `Drives.torques`.
TABLES, TORQUES = 0, 1
#: Rows of `Settings.numbers`.
PERIOD, ADVANCE, CLIMB, PREVIEW, RAMP, ADDED, ADDED_AT, ADDED_OVER, PAYLOAD, DT = range(10)


class Bodies(NamedTuple):
    """Views of MuJoCo's bodies beside `views.Mechanics`."""

    xpos: Array
    xmat: Array
    xipos: Array
    cvel: Array
    subtree_com: Array
    mocap_pos: Array
    mocap_quat: Array
    xfrc_applied: Array
    sensordata: Array
    body_mass: Array
    body_inertia: Array
    body_subtreemass: Array
    qfrc_constraint: Array
    qfrc_passive: Array
    dof_damping: Array
    site_xpos: Array
    ground: Index
    sole: Index
    foot: Index


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
    least: Array
    q: Array
    v: Array
    poses: Array
    force: Array
    motion: Array
    power: Array
    group: Index
    wrench: Array
    torque: Array
    other: Array
    carried: Array
    ground: Index
    mover: Mover


class Settings(NamedTuple):
    """What kind of run: the numbers of `PERIOD` to `DT`, and which parts are on."""

    numbers: Array
    kind: int
    controller: int
    asked: int
    root: int
    payload_body: int


@kernel
def _load_payload(fraction, settings, bodies):
    """Let part of the added mass hang on the frame: mass, inertia in proportion, and the sums that MuJoCo keeps."""
    n, body = settings.numbers, settings.payload_body
    mass = n[PAYLOAD] + fraction * n[ADDED]
    grown = mass / bodies.body_mass[body]
    change = mass - bodies.body_mass[body]
    for j in range(3):
        bodies.body_inertia[body, j] *= grown
    bodies.body_mass[body] = mass
    bodies.body_subtreemass[body] += change
    bodies.body_subtreemass[settings.root] += change
    bodies.body_subtreemass[0] += change


@inlined_kernel
def _ask(cycles, time, fraction, settings, mechanics, plant, wearer, drives):
    """From the phase to the force wanted of each rod, within what its cylinder can hold, and the ankles' torque."""
    n = settings.numbers
    if settings.asked == TORQUES:
        for j in range(6):
            wearer.torque[j] = drives.torques[j]
    else:
        ahead = cycles + n[PREVIEW] / n[PERIOD]
        look_up(ahead, wearer.demand, wearer.torque)
        if n[ADDED] > 0.0:
            look_up(ahead, wearer.demand_added, wearer.other)
            for j in range(6):
                wearer.torque[j] += fraction * (wearer.other[j] - wearer.torque[j])
        if time < n[RAMP]:
            for j in range(6):
                wearer.torque[j] *= time / n[RAMP]
    for i in range(plant.actuators.size):
        dof = plant.driven[i]
        arm = moment_arm(plant.actuators[i], dof, mechanics)
        plant.cylinders[i].arm = arm
        c = plant.cylinders[i]
        w = plant.world[0]
        low, high = force_limits(c.area_1, c.area_2, w.supply_pressure, w.exhaust_pressure, w.atmosphere)
        pull = spring_pull(c, mechanics.actuator_length[plant.actuators[i]] - plant.retracted[i])
        drives.before[i] = drives.wanted[i]
        drives.wanted[i] = min(max(wearer.torque[dof - 3] / arm if abs(arm) > 5e-3 else 0.0, low - pull), high - pull)
    for j in range(drives.ankles.size):
        if drives.ankles[j] >= 0:
            mechanics.ctrl[drives.ankles[j]] = wearer.torque[3 * j + 2]


@kernel
def run(first, count, settings, mechanics, plant, bodies, wearer, drives, log):
    """Take `count` steps, the first of the run being number 0; row i of `log` is what step first + i began with.

    Order: positions of now; gas up to now; person, straps, demand and valves at now; rod forces; MuJoCo's step. Return what became of
    the gas: where a step was refused it ends there, and the rows that are left are not numbers.
    """
    settings, mechanics, plant, bodies = borrow(settings), borrow(mechanics), borrow(plant), borrow(bodies)
    wearer, drives = borrow(wearer), borrow(drives)
    mover = wearer.mover
    embodied = mover.dofs.size > 0
    own = log.shape[1] - wearer_loop.COUNT  # where an embodied wearer's columns begin
    n = settings.numbers
    dt = n[DT]
    for k in range(first, first + count):
        call(mechanics.step1, mechanics.model, mechanics.data)
        time = k * dt
        cycles = time / n[PERIOD]
        if settings.kind == GAS and k > 0:
            became = advance_gas(mechanics, plant)
            if became != FOLLOWED:
                log[k - first :] = np.nan
                return became
        fraction = 0.0
        if n[ADDED] > 0.0:
            fraction = min(max((time - n[ADDED_AT]) / n[ADDED_OVER], 0.0), 1.0)
            _load_payload(fraction, settings, bodies)
        if embodied:
            wearer_torques.see(mechanics.qpos, mechanics.qvel, wearer.q, wearer.v, wearer.lengths, wearer.poses, mover)
        else:
            reference(cycles, n[PERIOD], n[ADVANCE], n[CLIMB], wearer.position, wearer.slope, wearer.q, wearer.v)
            segment_poses(wearer.q, wearer.v, wearer.lengths, wearer.poses)
            pose_bodies(wearer.poses, wearer.offset_y, bodies.mocap_pos, bodies.mocap_quat)
        pull(
            wearer.poses, bodies.xpos, bodies.xmat, bodies.xipos, bodies.cvel, bodies.subtree_com[settings.root],
            wearer.body, wearer.local, wearer.segment, wearer.anchor, wearer.stiffness, wearer.damping, wearer.least,
            bodies.xfrc_applied, wearer.force, wearer.motion, wearer.power, wearer.wrench,
        )  # fmt: skip
        _ask(cycles, time, fraction, settings, mechanics, plant, wearer, drives)
        if settings.kind == GAS:
            if drives.plan.shape[0] > 1:
                look_ahead(cycles, min(time / n[RAMP], 1.0), n[ADDED] > 0.0, fraction, plant, drives)
            open_valves(k, k == 0, dt, settings.controller, mechanics, plant, drives)
            compute_forces(mechanics, plant)
        else:
            for i in range(plant.actuators.size):
                mechanics.ctrl[plant.actuators[i]] = drives.wanted[i]
        for i in range(plant.actuators.size):
            drives.made[i] = mechanics.ctrl[plant.actuators[i]]
        log_motion(log[k - first], time, mechanics)
        if embodied:
            wearer_torques.ask(
                cycles, n[PERIOD], n[ADVANCE], n[CLIMB], wearer.position, wearer.slope, wearer.share, wearer.q, wearer.v, wearer.poses,
                wearer.lengths, mover,
            )  # fmt: skip
            wearer_torques.apply(wearer.poses, wearer.wrench, mechanics.qfrc_applied, mover)
            wearer_loop.log_before(log[k - first, own:], mechanics.qpos, mechanics.qvel, mover)
        call(mechanics.step2, mechanics.model, mechanics.data)
        log_rest(log[k - first], cycles, settings.kind == GAS, mechanics, plant, bodies, wearer, drives)
        if embodied:
            wearer_loop.log_after(
                log[k - first, own:], mechanics.qvel, bodies.sensordata, bodies.qfrc_constraint, bodies.qfrc_passive, bodies.dof_damping,
                wearer.ground, mover,
            )  # fmt: skip
    return FOLLOWED


@kernel
def _segments_along(cycles, period, advance, climb, position, slope, lengths, q, v, out):
    for i in range(cycles.size):
        reference(cycles[i], period, advance, climb, position, slope, q, v)
        segment_poses(q, v, lengths, out[i])


def person_along(time: Array, motion: Motion, person: Person) -> Array:
    """Return the person's segments at some times [s], shape (n, 7, 6), as the loop has them."""
    position, slope = motion.tables()
    out = np.empty((len(time), 7, 6))
    _segments_along(
        time / motion.period, motion.period, motion.advance, motion.climb, position, slope, person.lengths(), np.empty(9),
        np.empty(9), out,
    )  # fmt: skip
    return out
