"""Which joint each cylinder drives, and whether its stroke covers that joint's range."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError, RigError, nearest
from exo_sim.machine import mujoco_warnings  # noqa: F401 - its warnings are ours from here on
from exo_sim.rig import Cylinder, Rig

#: How far a piston may be asked beyond its stroke before the rig is refused [m].
STROKE_TOLERANCE = 1e-3
#: Share of its largest force that a cylinder's motor must let through.
_CLIPS = 0.98


@dataclass(frozen=True)
class Linkage:
    """One cylinder in the model.

    Attributes:
        cylinder: Its name.
        actuator: Index of the MJCF actuator.
        joint: Name of the joint it drives most directly.
        dof: That joint's degree of freedom.
        turning: True where the joint is a hinge.
    """

    cylinder: str
    actuator: int
    joint: str
    dof: int
    turning: bool


def linkages(rig: Rig, model: mujoco.MjModel) -> tuple[Linkage, ...]:
    """Return how each cylinder of the rig, in its order, hangs in the model.

    Raises:
        ModelError: the MJCF lacks an actuator, or has one that is no plain motor on a joint or tendon.
    """
    names = [model.actuator(i).name for i in range(model.nu)]
    found = []
    for cylinder in rig.cylinders.values():
        key = _key(rig, cylinder)
        if cylinder.actuator not in names:
            raise ModelError(f"{key}: no such actuator in {rig.model.name}{nearest(cylinder.actuator, names)}")
        index = names.index(cylinder.actuator)
        _check_actuator(rig, model, cylinder, index)
        dof = _driven_dof(model, index, key)
        joint = int(model.dof_jntid[dof])
        turning = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
        found.append(Linkage(cylinder.name, index, model.joint(joint).name, dof, bool(turning)))
    return tuple(found)


def check_motors(rig: Rig, model: mujoco.MjModel, links: Collection[Linkage]) -> None:
    """Refuse actuators that were edited after `linkages` found them: their force would be scaled or clipped in silence.

    Raises:
        ModelError: one is no plain motor any more, or clips what its cylinder exerts.
    """
    for link in links:
        _check_actuator(rig, model, rig.cylinders[link.cylinder], link.actuator)


def _check_actuator(rig: Rig, model: mujoco.MjModel, cylinder: Cylinder, index: int) -> None:
    key = _key(rig, cylinder)
    _check_motor(model, index, key)
    _check_reach(rig, model, cylinder, index, key)


def _key(rig: Rig, cylinder: Cylinder) -> str:
    return f'{rig.path}: cylinders.{cylinder.name}.actuator = "{cylinder.actuator}"'


def _check_motor(model: mujoco.MjModel, index: int, key: str) -> None:
    kinds = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_TENDON))
    if int(model.actuator_trntype[index]) not in kinds:
        raise ModelError(f"{key}: acts neither on a joint nor on a tendon; a cylinder needs one of these transmissions")
    plain = (int(mujoco.mjtGain.mjGAIN_FIXED), int(mujoco.mjtBias.mjBIAS_NONE), int(mujoco.mjtDyn.mjDYN_NONE))
    kind = (int(model.actuator_gaintype[index]), int(model.actuator_biastype[index]), int(model.actuator_dyntype[index]))
    if kind != plain or model.actuator_gainprm[index, 0] != 1.0:
        raise ModelError(f"{key}: is not a <motor> of gain 1; a cylinder writes its force in newtons into ctrl")


def _check_reach(rig: Rig, model: mujoco.MjModel, cylinder: Cylinder, index: int, key: str) -> None:
    """Refuse a motor that would cut off what the cylinder exerts: MuJoCo clips in silence."""
    over = max(rig.supply.pressure - rig.environment.pressure, 0.0) if cylinder.valve_area > 0.0 else 0.0
    low, high = (0.0 if cylinder.single_acting else -over * cylinder.area_2), over * cylinder.area_1
    gear = abs(float(model.actuator_gear[index, 0])) or 1.0
    moved = int(model.actuator_trnid[index, 0])
    on_joint = int(model.actuator_trntype[index]) == int(mujoco.mjtTrn.mjTRN_JOINT)
    held = (
        ("ctrlrange", model.actuator_ctrllimited[index], model.actuator_ctrlrange[index]),
        ("forcerange", model.actuator_forcelimited[index], model.actuator_forcerange[index]),
        ("actuatorfrcrange", model.jnt_actfrclimited[moved], model.jnt_actfrcrange[moved] / gear)
        if on_joint
        else ("actuatorfrcrange", model.tendon_actfrclimited[moved], model.tendon_actfrcrange[moved] / gear),
    )
    for name, limited, (least, most) in held:
        if limited and (least > _CLIPS * low or most < _CLIPS * high):
            raise ModelError(
                f"{key}: {name} in {rig.model.name} cuts its force to {least:g} to {most:g} N, but the cylinder exerts {low:.0f} to "
                f"{high:.0f} N; take {name} out of the MJCF, or widen it"
            )


def _driven_dof(model: mujoco.MjModel, index: int, key: str) -> int:
    """Return the degree of freedom with the largest moment over the joints' ranges."""
    data = mujoco.MjData(model)
    moments = np.zeros(model.nv)
    for share in (0.25, 0.5, 0.75):
        data.qpos[:] = at_share(model, share)
        mujoco.mj_forward(model, data)
        moments = np.maximum(moments, np.abs(moment_row(model, data, index)))
    sliding = np.array([model.jnt_type[model.dof_jntid[d]] in (2, 3) for d in range(model.nv)])
    moments = np.where(sliding, moments, 0.0)
    if not moments.max(initial=0.0) > 1e-6:
        raise ModelError(f"{key}: moves no hinge or slide joint; its linkage is singular")
    return int(np.argmax(moments))


def moment_row(model: mujoco.MjModel, data: mujoco.MjData, index: int) -> NDArray[np.float64]:
    """Return dlength/dq of an actuator, shape (nv,), after `mj_forward`."""
    row = np.zeros((model.nu, model.nv))
    mujoco.mju_sparse2dense(row, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
    return row[index]


def at_share(model: mujoco.MjModel, share: float) -> NDArray[np.float64]:
    """Return the positions with every limited hinge and slide at this share of its range, shape (nq,)."""
    qpos = np.array(model.qpos0)
    for joint in range(model.njnt):
        if model.jnt_limited[joint] and model.jnt_type[joint] in (2, 3):
            low, high = model.jnt_range[joint]
            qpos[model.jnt_qposadr[joint]] = low + share * (high - low)
    return qpos


def check_strokes(rig: Rig, model: mujoco.MjModel) -> None:
    """Refuse a rig whose cylinders cannot follow their joints, or whose linkage passes a dead centre.

    Raises:
        RigError: a stroke that is too short, or a moment arm that vanishes inside the joint's range.
    """
    data = mujoco.MjData(model)
    for link in linkages(rig, model):
        joint = int(model.dof_jntid[link.dof])
        if not model.jnt_limited[joint]:
            continue
        cylinder = rig.cylinders[link.cylinder]
        low, high = model.jnt_range[joint]
        lengths, arms = [], []
        for angle in np.linspace(low, high, 41):
            data.qpos[:] = model.qpos0
            data.qpos[model.jnt_qposadr[joint]] = angle
            mujoco.mj_forward(model, data)
            lengths.append(float(data.actuator_length[link.actuator]))
            arms.append(float(moment_row(model, data, link.actuator)[link.dof]))
        where = f"{rig.path}: cylinders.{link.cylinder}"
        if min(arms) < 0.0 < max(arms) or min(map(abs, arms)) < 1e-4:
            raise RigError(
                f'{where}: the linkage is singular inside the range of joint "{link.joint}": its moment arm goes from '
                f"{min(arms) * 1e3:.1f} to {max(arms) * 1e3:.1f} mm; move an attachment point"
            )
        short = cylinder.retracted_length - min(lengths)
        over = max(lengths) - cylinder.retracted_length - cylinder.stroke
        if short > STROKE_TOLERANCE or over > STROKE_TOLERANCE:
            raise RigError(
                f'{where}: stroke = {cylinder.stroke * 1e3:.1f} mm from {cylinder.retracted_length * 1e3:.1f} mm does not cover '
                f'joint "{link.joint}", which asks for {min(lengths) * 1e3:.1f} to {max(lengths) * 1e3:.1f} mm'
            )


def tendon_ends(model: mujoco.MjModel, actuator: str) -> tuple[int, int] | None:
    """Return the first and the last site of the tendon that an actuator pulls on, or None where it has none."""
    index = model.actuator(actuator).id
    if model.actuator_trntype[index] != mujoco.mjtTrn.mjTRN_TENDON:
        return None
    tendon = int(model.actuator_trnid[index, 0])
    start, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    sites = [
        int(model.wrap_objid[i])
        for i in range(start, start + count)
        if model.wrap_type[i] == mujoco.mjtWrap.mjWRAP_SITE
    ]
    return (sites[0], sites[-1]) if len(sites) > 1 else None
