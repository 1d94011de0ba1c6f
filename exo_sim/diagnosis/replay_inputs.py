"""What a replay is fed with: a recording on the simulation's steps, rid of what the rig says of its sensors."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.filters import smoothed, start_filter
from exo_sim.diagnosis.observed import breaks_of
from exo_sim.diagnosis.window_starts import cuts, unrest
from exo_sim.machine.linkage import Linkage, moment_row
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

Array = NDArray[np.float64]

#: Seconds of samples, and the most of them, that estimate the pressure at the start of a window.
START_SECONDS, START_SAMPLES = 0.015, 31
#: A joint that moves less than this [m, rad] over a whole recording is held by something.
STILL = 1e-4
#: The share of the forces' power that an unknown force may put into a joint before that counts as led from outside.
LED_SHARE = 0.12
_POWER_SMOOTHING, _POWER_BLOCK, MOST_JUDGED = 0.06, 0.1, 4000
#: A card may be so late [s] without anybody leading the joint.
_LATE = (-0.04, -0.02, -0.01, 0.0, 0.01, 0.02, 0.04)


@dataclass(frozen=True)
class Steps:
    """The steps of the simulation over one stretch of a recording's clock.

    Attributes:
        first, last: Samples of the stretch, last excluded.
        time: When each step begins [s], shape (n,), even.
        offset: Number of the stretch's first step in the whole run.
    """

    first: int
    last: int
    time: Array
    offset: int


def steps(time: Array, dt: float) -> list[Steps]:
    """Lay even steps over every stretch of a clock that does not jump."""
    edges = [*breaks_of(time), len(time)]
    found: list[Steps] = []
    offset = 0
    for first, last in itertools.pairwise(edges):
        if last - first < 5:
            continue
        count = math.ceil((time[last - 1] - time[first]) / dt - 1e-6) + 1
        found.append(Steps(first, last, time[first] + dt * np.arange(count), offset))
        offset += count
    return found


def window_starts(pieces: Sequence[Steps], seconds: float, time: Array, pressures: Sequence[Array | None]) -> NDArray[np.int64]:
    """Return the steps at which windows of about `seconds` begin; a window never runs across a jump of the clock.

    Args:
        pieces: The steps.
        seconds: Infinite for one window a stretch.
        time: Of the samples, shape (n,).
        pressures: What was measured: windows begin where it is quiet nearby, shape (n,) each.
    """
    starts: list[int] = []
    restless = unrest(pressures, len(time))
    for piece in pieces:
        for cut in cuts(time, piece.first, piece.last, seconds, restless):
            starts.append(piece.offset + int(np.searchsorted(piece.time, time[cut] - 1e-9)))
    return np.array(starts, dtype=np.int64)


def held(pieces: Sequence[Steps], time: Array, values: Array) -> Array:
    """Return the mean over each step of a value that is held from sample to sample, shape (steps,)."""
    out = []
    for piece in pieces:
        clock, held_values = time[piece.first : piece.last], _last_good(values[piece.first : piece.last])
        total = np.concatenate([[0.0], np.cumsum(held_values[:-1] * np.diff(clock))])
        dt = piece.time[1] - piece.time[0] if len(piece.time) > 1 else 1.0
        edges = np.append(piece.time, piece.time[-1] + dt)
        passed = np.interp(edges, clock, total) + np.maximum(edges - clock[-1], 0.0) * held_values[-1]
        out.append(np.diff(passed) / dt)
    return np.concatenate(out)


def between(pieces: Sequence[Steps], time: Array, values: Array | None, otherwise: float, ahead: float = 0.0) -> Array:
    """Return a value between samples, `ahead` seconds after each step's start, shape (steps,); a constant where there is none."""
    if values is None or np.isfinite(values).sum() < 2:
        return np.full(sum(len(piece.time) for piece in pieces), otherwise)
    good = np.isfinite(values)
    return np.concatenate([np.interp(piece.time + ahead, time[good], values[good]) for piece in pieces])


def motion(pieces: Sequence[Steps], time: Array, values: Array, earlier: float) -> tuple[Array, Array]:
    """Return smoothed position at each step and velocity `earlier` seconds before it, shape (steps,) each."""
    position, velocity = [], []
    for piece in pieces:
        clock = time[piece.first : piece.last]
        there, rate, change = smoothed(clock, values[piece.first : piece.last])
        position.append(np.interp(piece.time, clock, there))
        velocity.append(np.interp(piece.time, clock, rate - earlier * change))
    return np.concatenate(position), np.concatenate(velocity)


def start_pressures(pieces: Sequence[Steps], starts: NDArray[np.int64], time: Array, values: Array | None) -> Array:
    """Return the measured pressure at the start of each window, by a local parabola through what follows, shape (w,)."""
    found = np.full(len(starts), math.nan)
    if values is None:
        return found
    for w, start in enumerate(starts):
        piece = next(piece for piece in reversed(pieces) if piece.offset <= start)
        at = int(np.searchsorted(time, piece.time[start - piece.offset] - 1e-9))
        span = values[at : min(piece.last, at + START_SAMPLES)]
        clock = time[at : at + len(span)]
        span = span[clock - clock[0] <= START_SECONDS] if len(clock) else span
        good = np.isfinite(span)
        if not good.any():
            continue
        if good.all() and len(span) >= 5:
            found[w] = float(start_filter(len(span) - 1 + len(span) % 2) @ span[: len(span) - 1 + len(span) % 2])
        else:
            found[w] = float(span[good][0])
    return found


def recorded_joints(recording: Recording, model: mujoco.MjModel) -> list[int]:
    """Return the hinges and slides whose position was recorded, as MuJoCo's indices."""
    return [
        j
        for j in range(model.njnt)
        if model.jnt_type[j] in (2, 3) and _has(recording, f"{model.joint(j).name}.position")
    ]


def led_from_outside(recording: Recording, rig: Rig, model: mujoco.MjModel, links: Sequence[Linkage]) -> dict[str, str]:
    """Return the joints whose motion known forces cannot have made, and why: somebody led or held them unmeasured.

    Friction and drag only take power. So where inverse dynamics, measured pressures and the measured outside force leave an unknown
    force that puts power in, and much of it, a person or a test machine was at work. A joint whose pressures were not measured is
    taken as free.
    """
    joints = recorded_joints(recording, model)
    if len(joints) < model.njnt:
        missing = [model.joint(j).name for j in range(model.njnt) if j not in joints]
        why = f"the position of {', '.join(missing[:3])}{' and others' if len(missing) > 3 else ''} was not recorded"
        return {model.joint(j).name: why for j in joints}
    found = {}
    balance = _powers(recording, rig, model, links, joints)
    for j in joints:
        name = model.joint(j).name
        if _has(recording, f"{name}.external_force"):
            continue
        if float(np.ptp(recording[f"{name}.position"][np.isfinite(recording[f"{name}.position"])])) < STILL:
            found[name] = "it never moves, so something holds it"
        elif name in balance and balance[name] > LED_SHARE:
            found[name] = _put_in_words(balance[name])
    return found


def led_against(time: Array, needed: Array, drive: Array, velocity: Array) -> str:
    """Say how much power unmeasured forces put into a joint's motion, or "" where that is no more than friction's opposite.

    Args:
        time: Even clock, shape (n,).
        needed, drive: What the motion took and what is known to have driven it [N m, or N], shape (n,).
        velocity: Of the joint, shape (n,).
    """
    block = max(1, round(_POWER_BLOCK / float(np.median(np.diff(time)))))
    share = _put_in(needed, drive, velocity, block)
    return _put_in_words(share) if share > LED_SHARE else ""


def _put_in_words(share: float) -> str:
    return f"unmeasured forces put in {100 * share:.0f} % of the power that its motion took"


def _powers(
    recording: Recording, rig: Rig, model: mujoco.MjModel, links: Sequence[Linkage], joints: list[int]
) -> dict[str, float]:
    """Return, for each joint whose drive is known, the power that unknown forces put in as a share of what was known."""
    time = recording.time
    every = max(1, len(time) // MOST_JUDGED)
    usual = float(np.median(np.diff(time)))
    moves = [
        smoothed(time, recording[f"{model.joint(j).name}.position"], max(_POWER_SMOOTHING, 5 * usual)) for j in joints
    ]
    pick = np.arange(0, len(time), every)
    q, qd, qdd = np.zeros((len(pick), model.nq)), np.zeros((len(pick), model.nv)), np.zeros((len(pick), model.nv))
    for j, (position, velocity, acceleration) in zip(joints, moves, strict=True):
        q[:, model.jnt_qposadr[j]], qd[:, model.jnt_dofadr[j]] = position[pick], velocity[pick]
        qdd[:, model.jnt_dofadr[j]] = acceleration[pick]
    drive, known = _drive(recording, rig, links, pick)
    needed, gas = np.zeros((len(pick), model.nv)), np.zeros((len(pick), model.nv))
    data = mujoco.MjData(model)
    for i in range(len(pick)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], qd[i], qdd[i]
        mujoco.mj_inverse(model, data)
        needed[i] = data.qfrc_inverse
        for link in links:
            gas[i] += moment_row(model, data, link.actuator) * drive[link.cylinder][i]
    block = max(1, round(_POWER_BLOCK / (usual * every)))
    shares = {}
    for j in joints:
        name, dof = model.joint(j).name, int(model.jnt_dofadr[j])
        if any(link.dof == dof and link.cylinder not in known for link in links):
            continue
        shares[name] = min(
            _put_in(needed[:, dof], np.interp(time[pick] - late, time[pick], gas[:, dof]), qd[:, dof], block)
            for late in _LATE
        )
    return shares


def _put_in(needed: Array, drive: Array, velocity: Array, block: int) -> float:
    """Return the power that an unknown force puts in, over all power; a constant force (a gauge sensor's) does not count."""
    missing = needed - drive
    unknown = _blocks((missing - missing.mean()) * velocity, block)
    worked = np.maximum(np.abs(_blocks(drive * velocity, block)), np.abs(_blocks(needed * velocity, block))).sum()
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


def _filled(recording: Recording, key: str, pick: NDArray[np.int64]) -> Array | None:
    if not _has(recording, key):
        return None
    values = recording[key]
    good = np.isfinite(values)
    return np.interp(recording.time[pick], recording.time[good], values[good])


def _has(recording: Recording, key: str) -> bool:
    values = recording.get(key)
    return values is not None and int(np.isfinite(values).sum()) >= 5


def _blocks(values: Array, size: int) -> Array:
    whole = len(values) // size * size
    return values[:whole].reshape(-1, size).mean(axis=1)


def _last_good(values: Array) -> Array:
    good = np.isfinite(values)
    if good.all():
        return values
    index = np.maximum.accumulate(np.where(good, np.arange(len(values)), -1))
    return np.where(index >= 0, values[np.maximum(index, 0)], 0.0)
