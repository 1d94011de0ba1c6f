"""Which cylinders are sized alike: the groups that a machine's joints make, with what their linkages fix."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RigError, ScenarioError, nearest
from exo_sim.machine.attachment import attachments
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.rig import Attachment, Rig
from exo_sim.sizing.length_and_arm import length_and_arm

_RANGE_SAMPLES = 41


@dataclass(frozen=True)
class JointKind:
    """Cylinders that are sized alike: those of the left and the right hip, say.

    Attributes:
        name: "hip".
        cylinders: Their names.
        joints: The joints they drive, in the same order.
        across: Distance of a cylinder's ends along the joint's axis [m].
        own: The owner's attachment points.
        range: Of the joint [rad].
        direction: Sign of the owner's moment arm.
    """

    name: str
    cylinders: tuple[str, ...]
    joints: tuple[str, ...]
    across: float
    own: Attachment
    range: tuple[float, float]
    direction: float

    def sweep(self, attachment: Attachment) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return length and moment arm over the joint's range, the arm's sign as the owner's counted positive."""
        length, arm = length_and_arm(attachment, self.across, np.linspace(*self.range, _RANGE_SAMPLES))
        return length, arm * self.direction


def kinds_of(rig: Rig, only: tuple[str, ...] = ()) -> tuple[JointKind, ...]:
    """Return the groups of cylinders that are sized alike, in the order of the rig.

    Args:
        rig: The owner's machine.
        only: Names of the joints to size; all that have cylinders when empty.

    Raises:
        RigError: no cylinder with a valve, or a joint without bounds.
        ScenarioError: `only` names a joint that no cylinder drives.
        ModelError: a cylinder without attachment points.
    """
    model = load(rig)
    data = mujoco.MjData(model)
    points = attachments(rig, model)
    groups: dict[str, list[tuple[str, str, int]]] = {}
    links = linkages(rig, model)
    driven = [link.joint for link in links]
    for joint in only:
        if joint not in driven:
            raise ScenarioError(f'--joints: no cylinder of {rig.path} drives "{joint}"{nearest(joint, driven)}')
    for link in links:
        if only and link.joint not in only:
            continue
        if not link.turning:
            raise RigError(
                f'{rig.path}: cylinders.{link.cylinder} drives the sliding joint "{link.joint}"; sizing is for '
                "cylinders that turn the joints of a worn machine"
            )
        if link.joint.startswith("ankle") and rig.ankle.mode != "powered":
            raise RigError(
                f'{rig.path}: cylinders.{link.cylinder} drives an ankle, and ankle.mode = "{rig.ankle.mode}" asks nothing of it: write '
                'mode = "powered" and the largest torque that is wanted of it'
            )
        stem = link.joint[:-2] if link.joint.endswith(("_l", "_r")) else link.joint
        groups.setdefault(stem, []).append((link.cylinder, link.joint, link.dof))
    if not groups:
        raise RigError(f"{rig.path}: there is no cylinder to size; give the rig a [cylinders.NAME] table")
    found = []
    for stem, members in groups.items():
        name, joint, dof = members[0]
        index = int(model.dof_jntid[dof])
        if not model.jnt_limited[index]:
            raise RigError(f'{rig.path}: joint "{joint}" of {rig.model.name} has no range, so no stroke covers it; give it one')
        low, high = (float(bound) for bound in model.jnt_range[index])
        middle = np.array([0.5 * (low + high)])
        flat, arm = length_and_arm(points[name], 0.0, middle)
        data.qpos[:] = model.qpos0
        data.qpos[model.jnt_qposadr[index]] = middle[0]
        mujoco.mj_forward(model, data)
        whole = float(data.actuator(rig.cylinders[name].actuator).length[0])
        across = float(np.sqrt(max(whole**2 - flat[0] ** 2, 0.0)))
        found.append(
            JointKind(
                stem, tuple(m[0] for m in members), tuple(m[1] for m in members), across if across > 1e-6 else 0.0,
                points[name], (low, high), float(np.sign(arm[0])) or 1.0,
            )
        )  # fmt: skip
    return tuple(found)
