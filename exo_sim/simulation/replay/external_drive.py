"""Joints that a person or a test machine drove by forces that nobody measured, found from the power those forces put in."""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from exo_sim.conventions.undriven import is_undriven
from exo_sim.machine.joint_stops import touches_stop
from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.recording.filters import smoothed
from exo_sim.recording.noise import white_noise
from exo_sim.recording.table import Recording
from exo_sim.recording.windows import holes, mended_at
from exo_sim.rig import Rig
from exo_sim.simulation.replay.inputs import has_samples, recorded_joints

Array = NDArray[np.float64]

#: A joint that moves less than this [m, rad] over a whole recording is held by something.
STILL = 1e-4
#: A joint is driven from outside where an unknown force puts in more than this share of the power that is exchanged.
DRIVEN_SHARE = 0.12
#: And from this share on where another joint of the machine is: who moves one limb hardly leaves the others alone. Between the most of 46
#: whole machines that nobody drove, 0.023, and the least of 86 joints that wearers led, 0.080 (makes K to N, seeds 5101 and 7001).
DRIVEN_BESIDE = 0.045
#: Powers are compared on motion smoothed over this time [s], averaged over blocks of this length [s], on at most so many samples.
POWER_SMOOTHING, POWER_BLOCK, MOST_SAMPLES = 0.06, 0.1, 4000
#: So many free blocks at least tell a drive from a constant force. Asserted: a second of motion.
FEWEST_FREE = 10
#: Delays of the pressures' card that are tried [s]: the one with the smallest unknown power counts.
CARD_DELAYS = (-0.04, -0.02, -0.01, 0.0, 0.01, 0.02, 0.04)


def externally_driven(recording: Recording, rig: Rig, model: mujoco.MjModel, links: Sequence[Linkage]) -> dict[str, str]:
    """Return the joints that were driven or held by forces that nobody measured, and why.

    Friction and drag only dissipate. So where inverse dynamics, measured pressures and the measured outside force leave an unknown
    force that supplies much power, a person or a test machine was at work. A stop that throws a joint back supplies power too, and nobody
    measures its push: time at a stop does not count. A joint whose pressures were not measured counts as free, and so does every joint of a
    machine that nothing drives: a pendulum that is let go, of which only the position is recorded.
    """
    joints = recorded_joints(recording, model)
    if len(joints) < model.njnt:
        missing = [model.joint(j).name for j in range(model.njnt) if j not in joints]
        why = f"the position of {', '.join(missing[:3])}{' and others' if len(missing) > 3 else ''} was not recorded"
        return {model.joint(j).name: why for j in joints}
    found = {}
    balance = {} if is_undriven(recording, rig) else _power_shares(recording, rig, model, links, joints)
    unmeasured = [j for j in joints if not has_samples(recording, f"{model.joint(j).name}.external_force")]
    somebody = any(balance.get(model.joint(j).name, 0.0) > DRIVEN_SHARE for j in unmeasured)
    for j in unmeasured:
        name = model.joint(j).name
        if float(np.ptp(recording[f"{name}.position"][np.isfinite(recording[f"{name}.position"])])) < STILL:
            found[name] = "it never moves, so something holds it"
        elif name in balance and balance[name] > (DRIVEN_BESIDE if somebody else DRIVEN_SHARE):
            found[name] = _in_words(balance[name])
    return found


def external_power(time: Array, needed: Array, drive: Array, velocity: Array, free: NDArray[np.bool_] | None = None) -> str:
    """Return in words how much power unmeasured forces put into a joint's motion, or "" where it is too little to count.

    Args:
        time: Even clock, shape (n,).
        needed, drive: Force that the motion took and known driving force [N m, or N], shape (n,).
        velocity: Of the joint, shape (n,).
        free: Where no stop pushes it, shape (n,); everywhere when absent.
    """
    block = max(1, round(POWER_BLOCK / float(np.median(np.diff(time)))))
    share = _power_share(needed, drive, velocity, block, free)
    return _in_words(share) if share > DRIVEN_SHARE else ""


def _in_words(share: float) -> str:
    return f"unmeasured forces put in {100 * share:.0f} % of the power that its motion took"


def _power_shares(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: Sequence[Linkage], joints: list[int]
) -> dict[str, float]:
    """Return, for each joint whose drive is known, the power that unknown forces put in as a share of what was known."""
    time = recording.time
    every = max(1, len(time) // MOST_SAMPLES)
    usual = float(np.median(np.diff(time)))
    pick = np.arange(0, len(time), every)
    q, qd, qdd = _motion(recording, model, joints, pick, max(POWER_SMOOTHING, 5 * usual))
    drive, known = _drive(recording, rig, links, pick)
    needed, gas = np.zeros((len(pick), model.nv)), np.zeros((len(pick), model.nv))
    data = mujoco.MjData(model)
    place, rate, change, force = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
    simple = all(model.actuator_trntype[link.actuator] == int(mujoco.mjtTrn.mjTRN_JOINT) for link in links)
    levers = np.zeros((1 if simple else len(pick), len(links), model.nv))
    varying = len(levers)
    for i, (there, speed, acceleration) in enumerate(zip(q, qd, qdd, strict=True)):
        place[:], rate[:], change[:] = there, speed, acceleration
        mujoco.mj_inverse(model, data)
        needed[i] = force
        if i < varying:
            for k, link in enumerate(links):
                levers[i, k] = moment_row(model, data, link.actuator)
    for k, link in enumerate(links):
        gas += levers[:, k] * drive[link.cylinder][:, None]
    block = max(1, round(POWER_BLOCK / (usual * every)))
    shares = {}
    for j in joints:
        name, dof = model.joint(j).name, int(model.jnt_dofadr[j])
        if any(link.dof == dof and link.cylinder not in known for link in links):
            continue
        sides = [f"{link.cylinder}.pressure_{side}" for link in links if link.dof == dof for side in (1, 2)]
        free = _is_free(model, j, recording, sides)[pick]
        shares[name] = min(
            _power_share(needed[:, dof], np.interp(time[pick] - late, time[pick], gas[:, dof]), qd[:, dof], block, free)
            for late in CARD_DELAYS
        )
    return shares


def _motion(
    recording: Recording, model: mujoco.MjModel, joints: Sequence[int], pick: NDArray[np.int64], seconds: float
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Return positions, velocities and accelerations at some samples, smoothed: shape (picked, nq) and (picked, nv) twice."""
    n = len(pick)
    q, qd, qdd = np.zeros((n, model.nq)), np.zeros((n, model.nv)), np.zeros((n, model.nv))
    for j in joints:
        position, velocity, acceleration = smoothed(recording.time, recording[f"{model.joint(j).name}.position"], seconds)
        q[:, model.jnt_qposadr[j]], qd[:, model.jnt_dofadr[j]] = position[pick], velocity[pick]
        qdd[:, model.jnt_dofadr[j]] = acceleration[pick]
    return q, qd, qdd


def _is_free(model: mujoco.MjModel, joint: int, recording: Recording, sides: Sequence[str]) -> NDArray[np.bool_]:
    """Return where no stop pushes a joint and all was recorded, as far as the smoothed motion shows it, shape (n,).

    Args:
        model, joint: Whose.
        recording: Signals in SI, n samples.
        sides: Columns of what drives it.
    """
    column, time = f"{model.joint(joint).name}.position", recording.time
    position = _filled(recording, column, slice(None))
    assert position is not None
    spoilt = touches_stop(model, joint, position, white_noise(recording[column]))
    spoilt[mended_at(time, recording.breaks)] = True
    for key in (column, *(side for side in sides if side in recording)):
        for begin, end in holes(time, recording[key]):
            spoilt[begin:end] = True
    usual = float(np.median(np.diff(time)))
    return np.asarray(~binary_dilation(spoilt, iterations=math.ceil(max(POWER_SMOOTHING, 5 * usual) / usual)))


def _power_share(needed: Array, drive: Array, velocity: Array, block: int, free: NDArray[np.bool_] | None = None) -> float:
    """Return the power that an unknown force supplies as a share of all power; a constant force (a gauge sensor's) does not count.

    Blocks with a sample that is not free are left out. Of fewer than `FEWEST_FREE` none is said to be driven: who pushed in so short a time
    nobody can tell from a constant.
    """
    missing, whole = needed - drive, len(needed) // block * block
    free = np.ones(len(needed), dtype=bool) if free is None else free
    kept = np.asarray(free[:whole].reshape(-1, block).all(axis=1))
    if kept.sum() < min(FEWEST_FREE, whole // block):
        return 0.0
    constant = missing[free].mean() if free.any() else 0.0
    unknown = _blocks((missing - constant) * velocity, block)[kept]
    worked = np.maximum(np.abs(_blocks(drive * velocity, block)), np.abs(_blocks(needed * velocity, block)))[kept].sum()
    return float(np.maximum(unknown, 0.0).sum() / worked) if worked > 0.0 else 0.0


def _drive(
    recording: Recording, rig: Rig, links: Sequence[Linkage], pick: NDArray[np.int64]
) -> tuple[dict[str, Array], set[str]]:
    """Return the force of each cylinder from measured pressures, shape (picked,), and of which it is known."""
    forces, known = {}, set()
    atmosphere = rig.environment.pressure
    for link in links:
        c = rig.cylinders[link.cylinder]
        p_1 = _filled(recording, f"{c.name}.pressure_1", pick)
        p_2 = np.full(len(pick), atmosphere) if c.single_acting else _filled(recording, f"{c.name}.pressure_2", pick)
        if p_1 is None or p_2 is None:
            forces[c.name] = np.zeros(len(pick))
            continue
        known.add(c.name)
        forces[c.name] = p_1 * c.area_1 - p_2 * c.area_2 - atmosphere * (c.area_1 - c.area_2)
    return forces, known


def _filled(recording: Recording, key: str, pick: NDArray[np.int64] | slice) -> Array | None:
    if not has_samples(recording, key):
        return None
    values = recording[key]
    good = np.isfinite(values)
    if good.all():
        return values[pick]
    return np.interp(recording.time[pick], recording.time[good], values[good])


def _blocks(values: Array, size: int) -> Array:
    whole = len(values) // size * size
    return values[:whole].reshape(-1, size).mean(axis=1)
