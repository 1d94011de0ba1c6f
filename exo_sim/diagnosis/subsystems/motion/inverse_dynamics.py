"""Balances of forces of the joints: measured motion and pressures go in, the terms of the balance come out.

Inverse dynamics of the MJCF give the force that the motion took, the pressures and the outside force the force that drove it. Both pass
one filter, so that the acceleration is differentiated no more than that filter allows (which one: `motion_runs`). Friction, gravity,
centrifugal forces and what levers make of the forces of rods are evaluated at restored positions and velocities and filtered then; masses
count as constant over the filter's width.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions.fed_chambers import fed_cylinders
from exo_sim.diagnosis.data.motion_run import Drive, Inertia, Kinematics, MotionRun, Passive
from exo_sim.diagnosis.data.open_questions import Unjudged
from exo_sim.diagnosis.policy.recordings import STILL_NOISE, STILL_SHARE
from exo_sim.diagnosis.subsystems.motion.contact_forces import AtJoints, ContactForces, SiteForce, site_forces
from exo_sim.diagnosis.subsystems.motion.filter_width import AskedWidth
from exo_sim.diagnosis.subsystems.motion.forces_recorded import columns_of_balance, recorded
from exo_sim.diagnosis.subsystems.motion.kept_dynamics import KeptDynamics
from exo_sim.diagnosis.subsystems.motion.moving_masses import MovingMasses, payload, with_twice_the_payload
from exo_sim.diagnosis.subsystems.motion.resistance import resistance_along
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothed_alike, smoothing_width, stride, thinned
from exo_sim.diagnosis.subsystems.motion.stops import at_stop
from exo_sim.diagnosis.subsystems.motion.unjudged_balance import bound_by_model, not_recorded, rarely_free, rarely_known, rarely_whole
from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.recording.filters import EvenClock, SmoothedMotion, gaussian_smoothed, noise_gain, restored, smoothed_motion
from exo_sim.recording.noise import PIECE, white_noise
from exo_sim.recording.table import Recording
from exo_sim.recording.windows import clock_breaks
from exo_sim.rig import Rig, assembly

Array = NDArray[np.float64]

#: A small error in a position's zero, for its sensitivity [rad or m].
TILT = 1e-3


def balances(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: tuple[Linkage, ...], asked: AskedWidth | None
) -> tuple[list[MotionRun], list[tuple[str, Unjudged]]]:
    """Return the balance of every joint that can be judged, and (joint, reason) for those that cannot.

    Every joint of the model must have been recorded: a joint whose motion is unknown may carry any force.

    Args:
        recording: Signals in SI.
        rig, model, links: The machine.
        asked: The filter; the usual one of the clock where None.
    """
    smoothing = 0.0 if asked is None else asked.seconds
    names = [model.joint(j).name for j in range(model.njnt)]
    plain = [
        int(kind) in (int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)) for kind in model.jnt_type
    ]
    missing = [name for name, ok in zip(names, plain, strict=True) if not ok or f"{name}.position" not in recording]
    if missing:
        why = f"the position of {', '.join(missing[:3])}{' and others' if len(missing) > 3 else ''} was not recorded"
        unjudged = Unjudged(why, f"record {' and '.join(f'{name}.position' for name in missing[:3])} as well")
        return [], [(name, unjudged) for name in names if name not in missing] or [(name, unjudged) for name in names]
    contacts, why = site_forces(recording, model, smoothing)
    why = why or bound_by_model(model)
    if why:
        return [], [(name, Unjudged(why)) for name in names]
    time = recording.time
    seconds, every = smoothing_width(time, smoothing), stride(time)
    noise = (None,) * len(names) if asked is None else asked.noise
    moves = [_motion(time, recording[f"{name}.position"], seconds, every, one) for name, one in zip(names, noise, strict=True)]
    thin = thinned(time, every)
    n = len(thin)
    q, qd, qdd = np.zeros((n, model.nq)), np.zeros((n, model.nv)), np.zeros((n, model.nv))
    for j, move in enumerate(moves):
        q[:, model.jnt_qposadr[j]], qd[:, model.jnt_dofadr[j]] = move.position, move.velocity
        qdd[:, model.jnt_dofadr[j]] = move.acceleration
    along = (thin, (q, qd, qdd), links, contacts, smoothing)
    dynamics = _KEPT.of(model, along, lambda: _inverse(model, *along))
    fed, runs, reasons = fed_cylinders(recording, rig, model), [], []
    for j, name in enumerate(names):
        driven = [link for link in links if link.joint == name]
        dof = int(model.jnt_dofadr[j])
        pushed = f"{name}.external_force" in recording or bool(dynamics.contacts.reached[dof])
        known = dynamics.contacts.known[:, dof]
        free = ~at_stop(model, j, thin, moves[j], smoothing)
        columns = columns_of_balance(recording, rig, names, name, driven)
        whole = recorded(time, [recording[column] for column in columns], smoothing)
        lacks = not_recorded(recording, rig, driven, pushed, fed)
        reason = Unjudged(lacks) if lacks else rarely_known(thin, known) or rarely_free(thin, free) or rarely_whole(thin, whole, columns)
        if reason:
            reasons.append((name, reason))
        else:
            runs.append(_run(recording, rig, model, j, driven, moves, dynamics, known & free & whole, asked))
    return runs, reasons


def _motion(time: Array, position: Array, seconds: float, every: int, noise: float | None) -> SmoothedMotion:
    """Return how a joint moved, at every so many samples."""
    whole = smoothed_motion(time, position, seconds, noise)
    position, velocity, acceleration = (thinned(one, every) for one in (whole.position, whole.velocity, whole.acceleration))
    return replace(whole, position=position, velocity=velocity, acceleration=acceleration)


@dataclass(frozen=True)
class _Dynamics:
    """Inverse dynamics of all joints.

    Attributes:
        inertial, bias, carried, passive: Generalised forces, smoothed alike, shape (n, nv); that of the payload is in the first as well.
        tilt: Derivative of `bias` with respect to the positions' zeros, smoothed, shape (n, nv).
        arms: dX/dq of each link's own degree of freedom, shape (n, links).
        lengths: Of the links' actuators, shape (n, links).
        mass: The mass matrix at the end, shape (nv, nv).
        contacts: What straps and the ground do.
    """

    inertial: Array
    bias: Array
    carried: Array | None
    passive: Array
    tilt: Array
    arms: Array
    lengths: Array
    mass: Array
    contacts: ContactForces


#: Of the latest machines and motions.
_KEPT: KeptDynamics[_Dynamics] = KeptDynamics()


def _inverse(
    model: mujoco.MjModel, time: Array, motion: tuple[Array, Array, Array], links: tuple[Linkage, ...], forces: Sequence[SiteForce],
    smoothing: float,
) -> _Dynamics:  # fmt: skip
    """Return the inverse dynamics along a motion: positions, velocities and accelerations, shape (n, nq) and (n, nv) twice."""
    q = motion[0]
    n = len(q)
    free = model.opt.disableflags
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    masses, body = MovingMasses(model, time, motion, smoothing), payload(model)
    heavier = None if body is None else MovingMasses(with_twice_the_payload(model, body), time, motion, smoothing)
    arms, lengths = np.zeros((n, len(links))), np.zeros((n, len(links)))
    contacts = AtJoints(model, forces, time, smoothing)
    actuators = np.array([link.actuator for link in links], dtype=np.int64)
    simple = all(model.actuator_trntype[link.actuator] == int(mujoco.mjtTrn.mjTRN_JOINT) for link in links)
    of_actuators = masses.data.actuator_length
    try:
        for i in range(n):
            data = masses.move(i)
            if heavier is not None:
                heavier.move(i)
            contacts.add(i, data)
            if not simple or i == 0:
                for k, link in enumerate(links):
                    arms[i, k] = moment_row(model, data, link.actuator)[link.dof]
            lengths[i] = of_actuators[actuators]
    finally:
        model.opt.disableflags = free
    if simple and n:
        arms[:] = arms[0]
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, masses.data, full)
    inertial, bias = masses.gathered()
    carried = None if heavier is None else heavier.gathered()[0] - inertial
    tilted = _gravity(model, q + TILT) - _gravity(model, q) if model.nq == model.nv else np.zeros_like(bias)
    passive, tilted = (np.apply_along_axis(partial(smoothed_alike, time, asked=smoothing), 0, one) for one in (masses.passive, tilted))
    return _Dynamics(inertial, bias, carried, passive, tilted, arms, lengths, full, contacts.gathered())


def _carried(model: mujoco.MjModel, joint: int, force: Array | None) -> Array | None:
    """Return what a payload as heavy as all that a joint moves would ask of it, from what the payload does; None where it moves none."""
    body, root = payload(model), int(model.jnt_bodyid[joint])
    if force is None or body is None:
        return None
    above = body
    while above > root:
        above = int(model.body_parentid[above])
    return force * float(model.body_subtreemass[root] / model.body_mass[body]) if above == root else None


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


def _drive(
    recording: Recording, rig: Rig, driven: Sequence[Linkage], dynamics: _Dynamics, move: SmoothedMotion, variance: float,
    seconds: float,
) -> tuple[Drive, Array, Array, float, Array]:
    """Return the drive, position and velocity where friction acts, the balance's variance with that of the drive added, and a last thing.

    That is what resists pistons by the rig where several drive the joint, at the joint and before the filter [N or N m], shape (n,).
    """
    time, every, clock = recording.time, stride(recording.time), EvenClock.of(recording.time)
    n = len(dynamics.arms)
    keep = noise_gain(0, seconds, clock.usual)
    atmosphere = rig.environment.pressure

    def at_joint(lever: Array, values: Array, less: float = 0.0, area: float = 1.0) -> Array:
        """Return what a lever makes of the values, less a constant, times an area, behind the filter."""
        led = lever.copy() if every == 1 else np.interp(time, thinned(time, every), lever)
        for begin in range(0, len(led), PIECE):  # of an hour each product takes as much as a column
            piece = slice(begin, begin + PIECE)
            led[piece] *= (values[piece] - less) * area
        return thinned(gaussian_smoothed(time, led, seconds, clock), every)

    def behind_filter(pressure: Array | None, is_restored: bool) -> tuple[Array | None, Array]:
        """Return a pressure behind the filter, and the same restored, above the atmosphere, where that is asked for."""
        if pressure is None:
            return None, np.zeros(n)
        smooth = gaussian_smoothed(time, pressure, seconds, clock)
        above = thinned(restored(time, smooth, seconds, clock), every) - atmosphere if is_restored else np.zeros(n)
        return thinned(smooth, every), above

    force, gauge, arm = np.zeros(n), np.zeros((n, 2)), np.ones(n)
    levers: dict[str, Array] = {}
    signals: dict[str, Array] = {}
    cylinder: str | None = None
    position, velocity, resisted = move.position, move.velocity, np.zeros(n)
    records, thin = assembly.cylinders(rig), thinned(time, every)
    for link in driven:
        c = rig.cylinders[link.cylinder]
        index = list(rig.cylinders).index(link.cylinder)
        lever = dynamics.arms[:, index]
        cell = recording.get(f"{link.cylinder}.force")
        pressures = [recording.get(f"{link.cylinder}.pressure_{s}") for s in (1, 2)]
        smooth, gauges = zip(*(behind_filter(p, cell is None) for p in pressures), strict=True)
        if cell is not None:  # what the piston loses is in the balance along its rod
            signals[f"{link.cylinder}.force"] = thinned(gaussian_smoothed(time, cell, seconds, clock), every)
            force += at_joint(lever, cell)
            levers[f"{link.cylinder}.force"] = lever
            variance += float(np.mean(lever**2)) * (white_noise(cell) * keep) ** 2
        else:
            for p, area in zip(pressures, (c.area_1, 0.0 if c.single_acting else -c.area_2), strict=True):
                force += np.zeros(n) if p is None else at_joint(lever, p, atmosphere, area)
            for s, (p, filtered, area) in enumerate(zip(pressures, smooth, (c.area_1, -c.area_2), strict=True)):
                if p is not None and filtered is not None:
                    levers[f"{link.cylinder}.pressure_{s + 1}"] = lever * area
                    signals[f"{link.cylinder}.pressure_{s + 1}"] = filtered - atmosphere
                    variance += float(np.mean((lever * area) ** 2)) * (white_noise(p) * keep) ** 2
        if cell is not None:
            continue
        at_piston, pressed = dynamics.lengths[:, index] - c.retracted_length, np.column_stack(gauges)
        if len(driven) == 1:
            cylinder, arm, gauge, position, velocity = link.cylinder, lever, pressed, at_piston, lever * move.velocity
        else:
            own = np.empty(n)
            resistance_along(records[index], thin, at_piston, lever * move.velocity, pressed, own)
            resisted += lever * own
    return Drive(force, cylinder, arm, gauge, levers, signals), position, velocity, variance, resisted


def _run(
    recording: Recording, rig: Rig, model: mujoco.MjModel, joint: int, driven: Sequence[Linkage], moves: Sequence[SmoothedMotion],
    dynamics: _Dynamics, known: NDArray[np.bool_], asked: AskedWidth | None,
) -> MotionRun:  # fmt: skip
    name, dof = model.joint(joint).name, int(model.jnt_dofadr[joint])
    smoothing, every, step = asked.seconds if asked else 0.0, stride(recording.time), float(np.median(np.diff(recording.time)))
    seconds = smoothing_width(recording.time, smoothing)
    time = thinned(recording.time, every)
    move, mass = moves[joint], float(dynamics.mass[dof, dof])
    masses = [float(dynamics.mass[dof, model.jnt_dofadr[k]]) for k in range(len(moves))]
    lost = (0.0,) * len(moves) if asked is None else asked.bias
    shaken = sum((mass * one.position_noise * noise_gain(2, seconds, step)) ** 2 for mass, one in zip(masses, moves, strict=True))
    external = recording.get(f"{name}.external_force")
    variance = shaken + sum((mass * bias) ** 2 for mass, bias in zip(masses, lost, strict=True))
    drive, position, velocity, variance, resisted = _drive(recording, rig, driven, dynamics, move, variance, seconds)
    pushed = np.zeros(len(time)) if external is None else thinned(gaussian_smoothed(recording.time, external, seconds), every)
    if external is not None:
        column = f"{name}.external_force"
        drive = replace(drive, levers={**drive.levers, column: np.ones(len(time))}, signals={**drive.signals, column: pushed})
        variance += (white_noise(external) * noise_gain(0, seconds, step)) ** 2
    contacts = dynamics.contacts
    pushed = pushed + np.where(contacts.known[:, dof], contacts.force[:, dof], 0.0)
    variance += float(contacts.variance[dof])
    damping = float(model.dof_damping[dof].max())
    damped = -damping * smoothed_alike(time, move.velocity, asked=smoothing) if damping > 0.0 else None
    velocity_noise = move.velocity_noise * drive.usual_arm
    return MotionRun(
        recording=recording.name,
        joint=name,
        turning=bool(model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_HINGE)),
        time=time,
        breaks=tuple(dict.fromkeys(begin // every for begin in clock_breaks(recording.time, recording.breaks))),
        kinematics=Kinematics(
            position, velocity, max(STILL_NOISE * velocity_noise, STILL_SHARE * float(np.nanstd(velocity))), velocity_noise,
        ),
        inertia=Inertia(
            dynamics.inertial[:, dof], dynamics.bias[:, dof], dynamics.tilt[:, dof] / TILT,
            effective_mass=mass / max(float(np.median(drive.arm**2)), 1e-12),
            carried=_carried(model, joint, None if dynamics.carried is None else dynamics.carried[:, dof]),
            alone=model.nv == 1,
            noise=float(np.sqrt(shaken)),
        ),
        passive=Passive(dynamics.passive[:, dof] - smoothed_alike(time, resisted, asked=smoothing), damped),
        drive=drive,
        external=pushed,
        noise=float(np.sqrt(variance)),
        external_recorded=external is not None or bool(contacts.reached[dof]),
        known=None if known.all() else known,
        every=every,
        smoothing=smoothing,
    )  # fmt: skip
