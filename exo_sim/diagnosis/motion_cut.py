"""The motion cut: measured motion and measured pressures go in; the force that is missing in their balance comes out.

Inverse dynamics of the MJCF give the force that the motion took, the pressures and the outside force what was there. Both pass one
filter, so that acceleration needs no more differentiation than the filter bears. Friction, gravity and centrifugal forces are asked at
positions and velocities with what the filter took put back, and filtered then; levers and masses are taken for constant over the filter.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.filters import Moved, left_of_noise, moved, quieted, restored, white_noise
from exo_sim.diagnosis.observed import breaks_of
from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.physics.compiled import kernel
from exo_sim.physics.resistance import dry_level, move_bristle, piston_resistance
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Array = NDArray[np.float64]

#: A small error in a position's zero, to see what it does [rad or m].
TILT = 1e-3

#: Motion and forces are smoothed alike over this time [s].
SMOOTHING = 0.031
#: Behind that filter no more samples of a long recording are kept than this, while it spans at least so many of them.
MOST_SAMPLES, FEWEST_IN_FILTER = 400_000, 6


@dataclass
class MotionRun:
    """The balance of one joint in one recording; arrays of shape (n,), smoothed alike, in newtons or newton metres at the joint.

    Attributes:
        joint: Its name.
        cylinder: The one cylinder that drives it, or None.
        turning: True where it is a hinge.
        position, velocity: At the place where friction is asked: the piston's where a cylinder drives the joint, else the joint's.
        inertial: Force that mass times acceleration and gravity take, by the MJCF.
        bias: The part of `inertial` that does not go with acceleration: gravity and centrifugal forces.
        tilt: How `bias` answers one radian (metre) of error in the position's zero.
        passive: What the MJCF's own springs and dampers already exert.
        damped: The part of it that the damper exerts; None where there is none.
        drive: Force of the cylinders from measured pressures (or load cell), with the lever of each sensor's error.
        external: Measured generalised force from outside; zero where none was recorded.
        arm: Lever of the cylinder: dX/dq; 1 without one.
        gauge: Pressures above the atmosphere, shape (n, 2); zero without a cylinder.
        levers: How the drive answers one pascal (newton) too much in a column.
        noise: Standard deviation that sensor noise leaves in one smoothed sample.
        still: Below this speed the sign of the velocity is not known.
        breaks: Indices at which a new stretch begins.
        effective_mass: Mass that the piston feels [kg]; 0 where that plays no part.
        external_recorded: Whether `external` was measured.
        weighs: Whether a mass enters the balance.
        filled_in: Whether a pressure in it was not measured, and what the gas predicts stands in its place.
        unsure: How `drive` answers one standard deviation of each number that such a pressure hangs on.
        every: Of how many samples of the recording one was kept.
        leaks: How `drive` answers the parameters of a leak from that chamber, per unit of each.
    """

    recording: str
    joint: str
    cylinder: str | None
    turning: bool
    time: Array
    position: Array
    velocity: Array
    inertial: Array
    bias: Array
    tilt: Array
    passive: Array
    drive: Array
    external: Array
    arm: Array
    gauge: Array
    levers: dict[str, Array]
    noise: float
    still: float
    breaks: tuple[int, ...]
    effective_mass: float
    external_recorded: bool
    weighs: bool = True
    damped: Array | None = None
    every: int = 1
    filled_in: bool = False
    unsure: dict[str, Array] = field(default_factory=dict)
    leaks: dict[str, Array] = field(default_factory=dict)


@kernel
def resistance_along(c, time, x, v, gauge, out):
    """Write the force that resists a piston led along a measured motion [N], against +v.

    Args:
        c: Record CYLINDER.
        time, x, v: Motion, shape (n,).
        gauge: Pressures above the atmosphere, shape (n, 2).
        out: Result, shape (n,).
    """
    z = 0.0
    for i in range(time.size):
        level = dry_level(c, v[i], z, gauge[i, 0], gauge[i, 1])
        if i > 0:
            z = move_bristle(c, z, 0.5 * (v[i] + v[i - 1]), level, time[i] - time[i - 1])
        out[i] = piston_resistance(c, z, x[i], v[i], gauge[i, 0], gauge[i, 1])


def smoothing(time: Array) -> float:
    """Return the width of the filter that every term of a balance passes on this clock [s]."""
    return max(SMOOTHING, FEWEST_IN_FILTER * float(np.median(np.diff(time))))


def as_smooth(time: Array, values: Array) -> Array:
    """Return values behind the filter that the measured forces of a balance have passed, shape (n,)."""
    return quieted(time, values, smoothing(time))


def kept(time: Array) -> int:
    """Return of how many samples of this clock a balance keeps one."""
    spanned = smoothing(time) / float(np.median(np.diff(time)))
    return max(1, min(-(-len(time) // MOST_SAMPLES), int(spanned / FEWEST_IN_FILTER + 1e-9)))


def on_clock(run: MotionRun, time: Array, values: Array) -> Array:
    """Return values of a recording's clock at the samples that a balance of it keeps, shape of `run.time`."""
    return values if len(values) == len(run.time) else np.interp(run.time, time, values)


def smooth_on_clock(run: MotionRun, time: Array, values: Array) -> Array:
    """Return what a balance sees of values on a recording's clock: behind its filter, at the samples that it keeps."""
    return on_clock(run, time, as_smooth(time, values))


def motion_runs(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...]
) -> tuple[list[MotionRun], list[tuple[str, str]]]:
    """Return the balance of every joint that can be judged, and (joint, reason) for those that cannot.

    Every joint of the model must have been recorded: what is not known to move may carry any force.
    """
    names = [model.joint(j).name for j in range(model.njnt)]
    plain = [
        int(kind) in (int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)) for kind in model.jnt_type
    ]
    missing = [name for name, ok in zip(names, plain, strict=True) if not ok or f"{name}.position" not in recording]
    if missing:
        why = f"the position of {', '.join(missing[:3])}{' and others' if len(missing) > 3 else ''} was not recorded"
        return [], [(name, why) for name in names if name not in missing] or [(name, why) for name in names]
    if why := _touched(recording, model):
        return [], [(name, why) for name in names]
    time = recording.time
    seconds = smoothing(time)
    every = kept(time)
    moves = [_moved(time, recording[f"{name}.position"], seconds, every) for name in names]
    thin = _thinned(time, every)
    n = len(thin)
    q, qd, qdd = np.zeros((n, model.nq)), np.zeros((n, model.nv)), np.zeros((n, model.nv))
    for j, move in enumerate(moves):
        q[:, model.jnt_qposadr[j]], qd[:, model.jnt_dofadr[j]] = move.position, move.velocity
        qdd[:, model.jnt_dofadr[j]] = move.acceleration
    inertial, raw, passive, arms, lengths, mass = _inverse(model, q, qd, qdd, links)
    tilted = _gravity(model, q + TILT) - _gravity(model, q) if model.nq == model.nv else np.zeros_like(raw)
    bias, passive, tilted = (np.apply_along_axis(partial(as_smooth, thin), 0, one) for one in (raw, passive, tilted))
    inertial += bias - raw  # its acceleration was behind the filter already
    runs, reasons = [], []
    for j, name in enumerate(names):
        driven = [link for link in links if link.joint == name]
        dof = int(model.jnt_dofadr[j])
        external = recording.get(f"{name}.external_force")
        reason = _unjudgeable(recording, rig, driven, external is not None)
        if reason:
            reasons.append((name, reason))
            continue
        runs.append(
            _run(recording, rig, name, driven, (seconds, every), moves[j], inertial[:, dof], bias[:, dof], tilted[:, dof] / TILT,
                 passive[:, dof], arms, lengths, mass[dof],
                 external, model.jnt_type[j] == int(mujoco.mjtJoint.mjJNT_HINGE), float(model.dof_damping[dof].max()))
        )  # fmt: skip
    return runs, reasons


def _moved(time: Array, position: Array, seconds: float, every: int) -> Moved:
    """Return how a joint moved, at every so many samples."""
    whole = moved(time, position, seconds)
    position, velocity, acceleration = (_thinned(one, every) for one in (whole.position, whole.velocity, whole.acceleration))
    return replace(whole, position=position, velocity=velocity, acceleration=acceleration)


def _thinned(values: Array, every: int) -> Array:
    """Return one of every so many samples, shape (ceil(n / every),), as an array that keeps nothing else alive."""
    return np.ascontiguousarray(values[::every])


def _touched(recording: Recording, model: mujoco.MjModel) -> str:
    """Say what else pushes the machine than its joints' recorded forces, or "": then no balance of it closes."""
    pushed = sorted({key.split(".")[0] for key in recording.columns if "ground_force" in key or "strap_force" in key})
    if pushed:
        return f"forces on {', '.join(pushed[:2])} act at points that were not recorded"
    touching = (model.geom_contype != 0) & (model.geom_bodyid != 0)
    if touching.any() and model.nv > model.nu + 1:
        return "the machine touches the ground, and ground forces were not recorded"
    return ""


def _unjudgeable(recording: Recording, rig: Rig, driven: list[Linkage], external: bool) -> str:
    for link in driven:
        if f"{link.cylinder}.force" in recording:
            continue
        sides = ("pressure_1",) if rig.cylinders[link.cylinder].single_acting else ("pressure_1", "pressure_2")
        lacking = [s for s in sides if f"{link.cylinder}.{s}" not in recording]
        if lacking:
            return f"{link.cylinder}.{lacking[0]} was not recorded"
        if f"{link.cylinder}.valve_command" not in recording and not external:
            return f"nothing that was recorded drives {link.cylinder}: what moved it from outside is not known"
    return ""


def _inverse(
    model: mujoco.MjModel, q: Array, qd: Array, qdd: Array, links: tuple[Linkage, ...]
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Return inertial, bias and passive forces (n, nv), dX/dq of each link's own dof and lengths (n, links), and mass by dof (nv,)."""
    data = mujoco.MjData(model)
    n = len(q)
    free = model.opt.disableflags
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    inertial, bias, passive = np.zeros((3, n, model.nv))
    arms, lengths = np.zeros((n, len(links))), np.zeros((n, len(links)))
    simple = all(model.actuator_trntype[link.actuator] == int(mujoco.mjtTrn.mjTRN_JOINT) for link in links)
    try:
        for i in range(n):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[i], qd[i], qdd[i]
            mujoco.mj_inverse(model, data)
            inertial[i], passive[i] = data.qfrc_inverse + data.qfrc_passive, data.qfrc_passive
            bias[i] = data.qfrc_bias
            if not simple or i == 0:
                for k, link in enumerate(links):
                    arms[i, k] = moment_row(model, data, link.actuator)[link.dof]
            lengths[i] = data.actuator_length[[link.actuator for link in links]]
    finally:
        model.opt.disableflags = free
    if simple and n:
        arms[:] = arms[0]
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return inertial, bias, passive, arms, lengths, np.diag(full).copy()


def _gravity(model: mujoco.MjModel, q: Array) -> Array:
    """Return the generalised force that gravity asks at every position, shape (n, nv); zero for a machine on rails."""
    if all(int(kind) == int(mujoco.mjtJoint.mjJNT_SLIDE) for kind in model.jnt_type):
        return np.zeros((len(q), model.nv))
    data = mujoco.MjData(model)
    found = np.zeros((len(q), model.nv))
    for i, position in enumerate(q):
        data.qpos[:] = position
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_crb(model, data)
        mujoco.mj_rne(model, data, 0, found[i])
    return found


def _run(
    recording: Recording, rig: Rig, joint: str, driven: list[Linkage], filtered: tuple[float, int], move: Moved, inertial: Array,
    bias: Array, tilt: Array, passive: Array, arms: Array, lengths: Array, mass: float, external: Array | None, turning: bool,
    damping: float,
) -> MotionRun:  # fmt: skip
    seconds, every = filtered
    step = float(np.median(np.diff(recording.time)))
    time = _thinned(recording.time, every)
    n = len(time)
    keep = left_of_noise(0, seconds, step)

    def quiet(values: Array) -> Array:
        return _thinned(quieted(recording.time, values, seconds), every)

    def gauge_of(values: Array | None) -> Array:
        if values is None:
            return np.zeros(n)
        return _thinned(restored(recording.time, values, seconds), every) - atmosphere

    drive, gauge = np.zeros(n), np.zeros((n, 2))
    levers: dict[str, Array] = {}
    variance = (mass * move.jitter * left_of_noise(2, seconds, step)) ** 2
    arm = np.ones(n)
    cylinder: str | None = None
    atmosphere = rig.environment.pressure
    position, velocity = move.position, move.velocity
    for k, link in enumerate(driven):
        c = rig.cylinders[link.cylinder]
        index = list(rig.cylinders).index(link.cylinder)
        lever = arms[:, index]
        cell = recording.get(f"{link.cylinder}.force")
        pressures = [recording.get(f"{link.cylinder}.pressure_{s}") for s in (1, 2)]
        behind = [None if p is None else quieted(recording.time, p, seconds) for p in pressures]
        smooth = [None if p is None else _thinned(p, every) for p in behind]
        if cell is not None:  # what the piston loses is the rod's own balance
            drive += lever * quiet(cell)
            levers[f"{link.cylinder}.force"] = lever
            variance += float(np.mean(lever**2)) * (white_noise(cell) * keep) ** 2
        else:
            p_1 = smooth[0] if smooth[0] is not None else np.full(n, atmosphere)
            p_2 = np.full(n, atmosphere) if c.single_acting or smooth[1] is None else smooth[1]
            drive += lever * (p_1 * c.area_1 - p_2 * c.area_2 - atmosphere * (c.area_1 - c.area_2))
            for s, (p, area) in enumerate(zip(pressures, (c.area_1, -c.area_2), strict=True)):
                if p is not None:
                    levers[f"{link.cylinder}.pressure_{s + 1}"] = lever * area
                    variance += float(np.mean((lever * area) ** 2)) * (white_noise(p) * keep) ** 2
        if k == 0 and len(driven) == 1 and cell is None:
            cylinder, arm = link.cylinder, lever
            gauge = np.column_stack([gauge_of(p) for p in behind])
            position = lengths[:, index] - c.retracted_length
            velocity = lever * move.velocity
    pushed = np.zeros(n) if external is None else quiet(external)
    if external is not None:
        levers[f"{joint}.external_force"] = np.ones(n)
        variance += (white_noise(external) * keep) ** 2
    still = max(4.0 * move.shake * float(np.median(np.abs(arm))), 0.01 * float(np.nanstd(velocity)))
    breaks = tuple(dict.fromkeys(begin // every for begin in breaks_of(recording.time)))
    effective = mass / max(float(np.median(arm**2)), 1e-12)
    return MotionRun(
        recording.name, joint, cylinder, bool(turning), time, position, velocity, inertial, bias, tilt, passive, drive,
        pushed, arm, gauge, levers, float(np.sqrt(variance)), still, breaks, effective,
        external is not None, damped=-damping * as_smooth(time, move.velocity) if damping > 0.0 else None, every=every,
    )  # fmt: skip
