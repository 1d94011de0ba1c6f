"""Where cylinders hang in a compiled model: read from it, and moved in place to where the rig has them."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError
from exo_sim.machine.linkage import Linkage, linkages
from exo_sim.rig.schema import Attachment, Rig

_FLAT = [0, 2]


def attachments(rig: Rig, model: mujoco.MjModel) -> dict[str, Attachment]:
    """Return where the ends of each cylinder are in the model, from the axis of the joint it drives.

    Raises:
        ModelError: a cylinder that is no tendon between two sites.
    """
    found = {}
    data = _at_zero(model)
    for link in linkages(rig, model):
        ends = [data.site_xpos[site] - _axis(model, data, link.dof) for site in _sites(rig, model, link.cylinder)]
        found[link.cylinder] = Attachment(*((float(end[0]), float(end[2])) for end in ends))
    return found


def attach(
    model: mujoco.MjModel, rig: Rig, links: tuple[Linkage, ...] | None = None, data: mujoco.MjData | None = None
) -> None:
    """Move the sites of every cylinder that has an `attachment` in the rig, in place.

    The points are counted with all joints at zero, in space: x forward, z up. What lies across (y) stays.

    Args:
        model: Of the rig.
        rig: Where the points come from.
        links: `linkages(rig, model)` where they are at hand.
        data: Of the model, to work in; its positions are overwritten.

    Raises:
        ModelError: a cylinder that is no tendon between two sites.
    """
    moved = [cylinder for cylinder in rig.cylinders.values() if cylinder.attachment is not None]
    if not moved:
        return
    data = _at_zero(model, data)
    dofs = {link.cylinder: link.dof for link in links or linkages(rig, model)}
    for cylinder in moved:
        assert cylinder.attachment is not None
        axis = _axis(model, data, dofs[cylinder.name])
        ends = (cylinder.attachment.base, cylinder.attachment.rod)
        for site, end in zip(_sites(rig, model, cylinder.name), ends):
            place = data.site_xpos[site].copy()
            place[_FLAT] = axis[_FLAT] + end
            body = model.site_bodyid[site]
            model.site_pos[site] = data.xmat[body].reshape(3, 3).T @ (place - data.xpos[body])
    mujoco.mj_setConst(model, data)


def _at_zero(model: mujoco.MjModel, data: mujoco.MjData | None = None) -> mujoco.MjData:
    """Return data with all hinges at zero; slides stay where the model has them."""
    data = data or mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    hinge = model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE
    data.qpos[model.jnt_qposadr[hinge]] = 0.0
    mujoco.mj_kinematics(model, data)
    return data


def _axis(model: mujoco.MjModel, data: mujoco.MjData, dof: int) -> NDArray[np.float64]:
    return np.array(data.xanchor[model.dof_jntid[dof]])


def _sites(rig: Rig, model: mujoco.MjModel, name: str) -> tuple[int, int]:
    """Return the first and the last site of a cylinder's tendon."""
    index = model.actuator(rig.cylinders[name].actuator).id
    key = f"{rig.path}: cylinders.{name}"
    if model.actuator_trntype[index] != mujoco.mjtTrn.mjTRN_TENDON:
        raise ModelError(f"{key}: its actuator acts on a joint, so it has no attachment points to move; use a tendon")
    tendon = int(model.actuator_trnid[index, 0])
    wraps = range(int(model.tendon_adr[tendon]), int(model.tendon_adr[tendon] + model.tendon_num[tendon]))
    sites = [int(model.wrap_objid[i]) for i in wraps if model.wrap_type[i] == mujoco.mjtWrap.mjWRAP_SITE]
    if len(sites) != 2 or len(wraps) != 2:
        raise ModelError(f"{key}: attachment points need a tendon straight from one site to another")
    return sites[0], sites[1]
