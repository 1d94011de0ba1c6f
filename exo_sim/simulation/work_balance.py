"""Where the work of a walk comes from and goes to: wearer's joints, straps, cylinders, damping, ground, and what is left."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.machine import anthropometry
from exo_sim.machine.anthropometry import GRAVITY
from exo_sim.machine.metabolism import Metabolic, power
from exo_sim.machine.person import SEGMENTS
from exo_sim.simulation.running_statistics import Change, Mean, Peak, Rms
from exo_sim.simulation.walk import JOINTS, POWERS, STRAPPED, Walk
from exo_sim.simulation.wearer_inverse_dynamics import Held

_JOINTS = ("hip", "knee", "ankle")
#: Rows of `SEGMENTS` that straps of each part hold.
_BY_PART = {
    name: [i for i, segment in enumerate(SEGMENTS) if segment.split("_")[0] == part]
    for name, part in zip(STRAPPED, ("torso", "thigh", "foot"))
}


class Work(Mean):
    """Work a cycle [J]: the sum of powers times the step, over the number of cycles."""

    @classmethod
    def over(cls, power: NDArray[np.float64], walk: Walk) -> Work:
        """Take the power at some rows [W]."""
        return cls(float(np.sum(power)) * walk.motion.stride_time, len(power))


def measure(walk: Walk, rows: slice, it: Held) -> dict[str, Any]:
    """Return works of some rows by where they are done, as reductions in the places of the JSON's `ledger`.

    Args:
        walk: What was simulated.
        rows: Whole cycles of it.
        it: The wearer with the machine, at every row of the walk.
    """
    part = {name: walk.columns[f"ledger.{name}_power"][rows] for name in POWERS}
    wearer = {name: _both_ways(power[rows], walk) for name, power in it.by_joint().items()}
    torque = np.stack([walk.columns[f"{name}.torque"][rows] * walk.columns[f"{name}.velocity"][rows] for name in JOINTS], axis=1)
    on_wearer = strap_power(walk)[rows]
    straps = {name: part[f"{name}_strap"] + on_wearer[:, i] for i, name in enumerate(STRAPPED)}
    pelvis = walk.poses[rows][:, 0]
    residual = _at_pelvis(it.ground.residual[rows], pelvis)
    yielded = np.zeros(len(residual)) if walk.moved is None else walk.moved.yielded[rows]
    seat = _at_pelvis(it.ground.seat[rows], pelvis)
    # what is summed are the means, which do not depend on where the signs change
    flows = {
        "joints": it.powers[rows].sum(axis=1), "feet": it.sole_powers[rows].sum(axis=1), "straps": sum(straps.values()), "yielded": yielded,
        "actuators": part["actuator"], "damping": part["damping"] + part["spring"],
        "ground": part["ground"], "seat": seat, "residual": residual,
    }  # fmt: skip
    out = {
        "unit": "J/stride",
        "wearer_joints": wearer,
        "straps": {name: Work.over(one, walk) for name, one in straps.items()},
        "straps_on_machine": {name: Work.over(part[f"{name}_strap"], walk) for name in STRAPPED},
        "cylinders": _both_ways(torque, walk),
        "machine_damping": Work.over(part["damping"], walk),
        "machine_springs": Work.over(part["spring"], walk),
        "ground": Work.over(part["ground"], walk),
        **({} if walk.moved is None else {"soles": Work.over(yielded, walk)}),
        "seat": Work.over(seat, walk),
        "residual": Work.over(residual, walk),
        "stored": stored(walk, rows),
        "brought": Work(_brought(walk, rows) * walk.motion.stride_time / walk.step, rows.stop - rows.start),
        "closure": Work.over(sum(flows.values()), walk),
    }  # fmt: skip
    return out


def closed(ledger: Mapping[str, Any]) -> dict[str, Any]:
    """Return the ledger's numbers with the closure: all work done, and what an added load brings, less what is stored [J a cycle]."""
    return {**ledger, "closure": ledger["closure"] + ledger["brought"] - ledger["stored"]}


def stored(walk: Walk, rows: slice) -> Change:
    """Return by how much the energy of machine and wearer grows over some rows [J a cycle]."""
    ends = [rows.start, min(rows.stop, len(walk.time) - 1)]
    wearer = anthropometry.energy(walk.poses[ends], walk.person) if walk.moved is None else np.zeros(2)  # in the model itself
    first, last = (machine_energy(walk, row) + float(own) for row, own in zip(ends, wearer))
    return Change(first, last, (rows.stop - rows.start) * walk.step / walk.motion.stride_time)


def machine_energy(walk: Walk, row: int) -> float:
    """Return kinetic energy and energy of weight of the machine at a row [J]; springs count as work."""
    model = walk.model
    body = int(model.geom("payload").bodyid[0])
    mass, inertia = float(model.body_mass[body]), model.body_inertia[body].copy()
    grown = max(float(walk.payload[row]), 1e-6) / mass
    data = mujoco.MjData(model)
    for i in range(model.njnt):
        name = model.joint(i).name
        data.qpos[i], data.qvel[i] = walk.columns[f"{name}.position"][row], walk.columns[f"{name}.velocity"][row]
    stiffness = model.jnt_stiffness.copy()
    try:
        model.body_mass[body], model.body_inertia[body] = mass * grown, inertia * grown
        model.jnt_stiffness[:] = 0.0
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_energyPos(model, data)
        mujoco.mj_energyVel(model, data)
        return float(data.energy.sum())
    finally:
        model.body_mass[body], model.body_inertia[body] = mass, inertia
        model.jnt_stiffness[:] = stiffness


def strap_power(walk: Walk) -> NDArray[np.float64]:
    """Return what the straps give the wearer by part of the body [W], columns as `STRAPPED`, shape (n, 3)."""
    poses, wrench = walk.poses, walk.wrench
    power = wrench[:, :, 0] * poses[:, :, 3] + wrench[:, :, 1] * poses[:, :, 4] + wrench[:, :, 2] * poses[:, :, 5]
    return np.stack([power[:, _BY_PART[name]].sum(axis=1) for name in STRAPPED], axis=1)


def _strength(walk: Walk, rows: slice, segments: list[int]) -> dict[str, Any]:
    """Return how strongly all straps of a segment together pull it, rms and most of left and right [N]."""
    force = walk.wrench[rows][:, segments, :2]
    strength = np.hypot(force[:, :, 0], force[:, :, 1])
    return {"rms": Rms.of(strength), "peak": Peak.of(strength)}


def wearer_numbers(walk: Walk, rows: slice, it: Held) -> dict[str, Any]:
    """Return what the contract has under `wearer` beside the extra moments, as reductions."""
    residual = it.ground.residual[rows]
    force = np.hypot(residual[:, 0], residual[:, 1])
    push = walk.wrench[rows][:, :, 0].sum(axis=1)
    to_machine = sum(walk.columns[f"ledger.{name}_strap_power"][rows] for name in STRAPPED)
    return {
        "moment_rms_nm": {name: Rms.of(it.moments[rows][:, k::3]) for k, name in enumerate(_JOINTS)},
        "strap_force_n": {name: _strength(walk, rows, segments) for name, segments in _BY_PART.items()},
        "forward_push_n": Mean.of(-push),
        "power_to_machine_w": Mean.of(to_machine),
        "pelvis_residual": {
            "force_peak_n": Peak.of(force), "force_rms_n": Rms.of(force),
            "moment_peak_nm": Peak.of(np.abs(residual[:, 2])), "moment_rms_nm": Rms.of(residual[:, 2]),
        },
        "pressure_centre_outside_share": Mean.of(it.ground.outside[rows]),
        "trunk_lean_deg": Mean.of(-np.degrees(walk.poses[rows][:, 0, 2])),
    }  # fmt: skip


def compared(it: Held, walk: Walk) -> dict[str, Any]:
    """Return a column of `compared_with`, of a body held along one cycle."""
    period = walk.motion.stride_time
    work = {
        name: [float(np.maximum(power, 0.0).mean(axis=0).sum()) * period, float(np.minimum(power, 0.0).mean(axis=0).sum()) * period]
        for name, power in it.by_joint().items()
    }
    cost = cost_of(work, walk)
    residual = it.ground.residual
    force = np.hypot(residual[:, 0], residual[:, 1])
    return {
        "metabolic_w": cost.value,
        "metabolic_low_w": cost.low,
        "metabolic_high_w": cost.high,
        "wearer_joints": work,
        "moment_rms_nm": {name: float(np.sqrt(np.mean(it.moments[:, k::3] ** 2))) for k, name in enumerate(_JOINTS)},
        "pelvis_residual": {
            "force_peak_n": float(force.max()), "force_rms_n": float(np.sqrt(np.mean(force**2))),
            "moment_peak_nm": float(np.abs(residual[:, 2]).max()), "moment_rms_nm": float(np.sqrt(np.mean(residual[:, 2] ** 2))),
        },
        "pressure_centre_outside_share": float(it.ground.outside.mean()),
        "trunk_lean_deg": float(-np.degrees(it.poses[:, 0, 2]).mean()),
    }  # fmt: skip


def cost_of(joints: Mapping[str, list[float]], walk: Walk) -> Metabolic:
    """Return the metabolic power of joint works [J a cycle]. What a foot absorbs below the ankle costs nothing, what it gives does."""
    period = walk.motion.stride_time
    positive = sum(pair[0] for pair in joints.values())
    negative = sum(pair[1] for name, pair in joints.items() if name != "foot")
    return power(positive / period, negative / period, walk.person.mass)


def _both_ways(powers: NDArray[np.float64], walk: Walk) -> list[Work]:
    """Return positive and negative work of some powers, shape (n, m)."""
    return [Work.over(np.maximum(powers, 0.0).sum(axis=1), walk), Work.over(np.minimum(powers, 0.0).sum(axis=1), walk)]


def _at_pelvis(wrench: NDArray[np.float64], pelvis: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((wrench * pelvis[:, 3:6]).sum(axis=1))


def _brought(walk: Walk, rows: slice) -> float:
    """Return the energy that mass put on the back brings with it [J]."""
    added = np.diff(walk.payload[rows])
    if not added.any():
        return 0.0
    body = int(walk.model.geom("payload").bodyid[0])
    x, z = walk.model.body_pos[body][[0, 2]] + walk.model.body_ipos[body][[0, 2]]
    pitch = walk.columns["torso_pitch.position"][rows]
    height = walk.columns["torso_z.position"][rows] + x * np.sin(pitch) + z * np.cos(pitch)
    return float((added * GRAVITY * 0.5 * (height[1:] + height[:-1])).sum())
