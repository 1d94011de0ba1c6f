"""The straps between wearer and machine: explicit spring-dampers between points of two rigid bodies.

MuJoCo's welds to mocap bodies would lag and drag (such bodies have no velocity), and their softness scales with mass; here stiffness is
in N/m and the person's real velocity is used. A strap stands for all that holds at its place, so that most push as well as pull: of
harness and cuff the pad pushes and the strap round the body pulls, a shoe does both. Shoulder straps only pull: the machine can hang on
them, and cannot lift them. That counts where the wearer is a body (`one_sided`); one whose motion is prescribed is held both ways.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ModelError
from exo_sim.machine.person import SEGMENTS, Person
from exo_sim.physics.compiled import inlined_kernel

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True)
class Strap:
    """One attachment.

    Attributes:
        site: The MJCF site on the machine; also the strap's name in recordings.
        segment: The person's segment it holds.
        stiffness: Across and along the segment (its x and z axes) [N/m].
        damping: The same [N s/m].
        lifts: Whether it can push its segment up along itself: a belt with loops round the legs can, shoulder straps cannot.
    """

    site: str
    segment: str
    stiffness: tuple[float, float]
    damping: tuple[float, float]
    lifts: bool = True


def worn() -> tuple[Strap, ...]:
    """Return the straps of a worn machine: harness at two heights, cuffs at the thighs, shoes at heel and ball."""
    straps = [Strap(f"torso_strap_{at}", "torso", (8e3, 8e3), (320.0, 320.0), at == "low") for at in ("low", "high")]
    for side in "lr":
        straps.append(Strap(f"thigh_{side}_strap", f"thigh_{side}", (1e4, 1e3), (140.0, 40.0)))
        straps += [Strap(f"foot_{side}_strap_{at}", f"foot_{side}", (5e3, 5e3), (50.0, 50.0)) for at in ("heel", "toe")]
    return tuple(straps)


@dataclass(frozen=True)
class StrapSet:
    """All straps as arrays for the kernel, n straps.

    Attributes:
        names: The sites' names.
        body: Body of each site, shape (n,).
        local: Site in its body [m], shape (n, 3).
        segment: Row of the person's segment, shape (n,).
        anchor: The same point in the segment, x and z [m], shape (n, 2).
        stiffness, damping: Across and along the segment, shapes (n, 2).
        least: Least force along the segment on the machine [N], shape (n,): 0 for a strap that cannot lift its segment.
    """

    names: tuple[str, ...]
    body: NDArray[np.int64]
    local: NDArray[np.float64]
    segment: NDArray[np.int64]
    anchor: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]
    least: NDArray[np.float64]

    def stiffened(self, factor: float) -> StrapSet:
        """Return straps so many times as stiff; their damping grows with the root, which keeps the damping ratio of what hangs on them."""
        return replace(self, stiffness=factor * self.stiffness, damping=math.sqrt(factor) * self.damping)


def fasten(model: mujoco.MjModel, person: Person, straps: tuple[Strap, ...] | None = None, one_sided: bool = False) -> StrapSet:
    """Fasten the straps with machine and person both upright, where all are slack.

    Args:
        model: Of the machine.
        person: Who wears it.
        straps: Those of a worn machine when None.
        one_sided: Straps that cannot lift do not.

    Raises:
        ModelError: the model lacks a strap's site.
    """
    import mujoco

    straps = worn() if straps is None else straps
    site = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, strap.site) for strap in straps]
    for strap, index in zip(straps, site):
        if index < 0:
            raise ModelError(f'the model has no site "{strap.site}" for a strap; add it to the MJCF')
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    mujoco.mj_kinematics(model, data)
    hip = np.array([0.0, data.xpos[model.site_bodyid[site[0]], 2]])
    origin = {"torso": hip}
    for side in "lr":
        origin[f"thigh_{side}"] = hip
        origin[f"shank_{side}"] = hip - [0.0, person.thigh]
        origin[f"foot_{side}"] = hip - [0.0, person.thigh + person.shank]
    anchor = [data.site_xpos[i][[0, 2]] - origin[strap.segment] for strap, i in zip(straps, site)]
    return StrapSet(
        names=tuple(strap.site for strap in straps),
        body=np.array([model.site_bodyid[i] for i in site], dtype=np.int64),
        local=np.array([model.site_pos[i] for i in site]),
        segment=np.array([SEGMENTS.index(strap.segment) for strap in straps], dtype=np.int64),
        anchor=np.array(anchor),
        stiffness=np.array([strap.stiffness for strap in straps]),
        damping=np.array([strap.damping for strap in straps]),
        least=np.array([0.0 if one_sided and not strap.lifts else -np.inf for strap in straps]),
    )


@inlined_kernel
def pull(
    poses: NDArray[np.float64],
    xpos: NDArray[np.float64],
    xmat: NDArray[np.float64],
    xipos: NDArray[np.float64],
    cvel: NDArray[np.float64],
    centre: NDArray[np.float64],
    body: NDArray[np.int64],
    local: NDArray[np.float64],
    segment: NDArray[np.int64],
    anchor: NDArray[np.float64],
    stiffness: NDArray[np.float64],
    damping: NDArray[np.float64],
    least: NDArray[np.float64],
    xfrc_applied: NDArray[np.float64],
    force: NDArray[np.float64],
    motion: NDArray[np.float64],
    power: NDArray[np.float64],
    wrench: NDArray[np.float64],
) -> None:
    """Compute every strap's force and apply it to the machine's bodies.

    Args:
        poses: The person's segments, shape (7, 6).
        xpos, xmat, xipos, cvel, centre: MuJoCo's xpos, xmat, xipos, cvel and subtree_com of the machine's root body.
        body, local, segment, anchor, stiffness, damping, least: Of a `StrapSet`.
        xfrc_applied: MuJoCo's; overwritten for every body that a strap holds.
        force: Force on the machine, x and z [N], shape (n, 2); that of the step before is read, that of now written.
        motion: Velocity of the same points [m/s], shape (n, 2); the same.
        power: Written: mean power of each strap on the machine over the step before [W], shape (n,).
        wrench: Written: force x, z [N] and moment about -y [N m] on each segment of the person about its origin, (7,
            3).
    """
    for i in range(body.shape[0]):
        for k in range(6):
            xfrc_applied[body[i], k] = 0.0
    wrench[:] = 0.0
    for i in range(body.shape[0]):
        b, s = body[i], segment[i]
        px = xpos[b, 0] + xmat[b, 0] * local[i, 0] + xmat[b, 1] * local[i, 1] + xmat[b, 2] * local[i, 2]
        pz = xpos[b, 2] + xmat[b, 6] * local[i, 0] + xmat[b, 7] * local[i, 1] + xmat[b, 8] * local[i, 2]
        turning = cvel[b, 1]
        pvx = cvel[b, 3] + turning * (pz - centre[2])
        pvz = cvel[b, 5] - turning * (px - centre[0])
        sine, cosine = math.sin(poses[s, 2]), math.cos(poses[s, 2])
        rx = cosine * anchor[i, 0] - sine * anchor[i, 1]
        rz = sine * anchor[i, 0] + cosine * anchor[i, 1]
        ex, ez = poses[s, 0] + rx - px, poses[s, 1] + rz - pz
        evx, evz = poses[s, 3] - rz * poses[s, 5] - pvx, poses[s, 4] + rx * poses[s, 5] - pvz
        across = stiffness[i, 0] * (cosine * ex + sine * ez) + damping[i, 0] * (cosine * evx + sine * evz)
        along = stiffness[i, 1] * (cosine * ez - sine * ex) + damping[i, 1] * (cosine * evz - sine * evx)
        along = max(along, least[i])
        fx, fz = cosine * across - sine * along, sine * across + cosine * along
        power[i] = 0.5 * (force[i, 0] * (motion[i, 0] + pvx) + force[i, 1] * (motion[i, 1] + pvz))
        force[i, 0], force[i, 1] = fx, fz
        motion[i, 0], motion[i, 1] = pvx, pvz
        xfrc_applied[b, 0] += fx
        xfrc_applied[b, 2] += fz
        xfrc_applied[b, 4] += (pz - xipos[b, 2]) * fx - (px - xipos[b, 0]) * fz
        wrench[s, 0] -= fx
        wrench[s, 1] -= fz
        wrench[s, 2] -= rx * fz - rz * fx
