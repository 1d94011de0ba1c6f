"""What the straps do to the wearer: the moments that hip, knee and ankle must give in addition to those of walking
alone.

The wearer's motion is prescribed, so whatever wrench the straps impose must reach the ground through the wearer's own
legs. In
single support that determines every joint's extra moment. In double support the ground's answer is shared between the
feet with
the least weighted norm, the weight being the share of load that each foot carries in the gait.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.person import SEGMENTS

#: A moment under a foot counts as much as the force that makes it on this arm [m].
_FOOT_ARM = 0.1
_LEAST_SHARE = 1e-3
GRAVITY = 9.81


def extra_moments(
    poses: NDArray[np.float64],
    wrench: NDArray[np.float64],
    share: NDArray[np.float64],
    pressure_centre: NDArray[np.float64],
    ankle_height: float,
) -> NDArray[np.float64]:
    """Compute the wearer's extra joint moments.

    Args:
        poses: The person's segments, of which x, z [m] and angle [rad] are used, shape (n, 7, 6).
        wrench: Force x, z [N] and moment about -y [N m] on each segment about its upper joint, shape (n, 7, 3).
        share: Share of left and right foot in carrying, shape (n, 2).
        pressure_centre: Ahead of each ankle along the sole [m], shape (n, 2).
        ankle_height: Ankle above the sole [m].

    Returns:
        hip, knee, ankle of the left, then of the right leg [N m]; flexion, extension, dorsiflexion positive, shape
        (n, 6).
    """
    origin = poses[:, :, :2]
    about_pelvis = origin - origin[:, :1]
    moment = wrench[:, :, 2] + about_pelvis[:, :, 0] * wrench[:, :, 1] - about_pelvis[:, :, 1] * wrench[:, :, 0]
    total = np.stack([wrench[:, :, 0].sum(axis=1), wrench[:, :, 1].sum(axis=1), moment.sum(axis=1)], axis=1)

    foot_rows = [SEGMENTS.index("foot_l"), SEGMENTS.index("foot_r")]
    angle = poses[:, foot_rows, 2]
    ahead, below = pressure_centre, -ankle_height
    centre = about_pelvis[:, foot_rows] + np.stack(
        [ahead * np.cos(angle) - below * np.sin(angle), ahead * np.sin(angle) + below * np.cos(angle)], axis=-1
    )
    # least weighted norm under the balance of x, z and moment about the pelvis; x and z share nothing but the moment
    weight = np.maximum(share, _LEAST_SHARE)
    lean, reach = (weight * centre[:, :, 1]).sum(axis=1), (weight * centre[:, :, 0]).sum(axis=1)
    load = weight.sum(axis=1)
    turn = (weight * ((centre**2).sum(axis=2) + _FOOT_ARM**2)).sum(axis=1)
    spin = (total[:, 2] + (lean * total[:, 0] - reach * total[:, 1]) / load) / (turn - (lean**2 + reach**2) / load)
    push, lift = (total[:, 0] + lean * spin) / load, (total[:, 1] - reach * spin) / load
    n = len(poses)
    ground = np.empty((n, 6))
    for foot in range(2):
        carries = weight[:, foot]
        ground[:, 3 * foot] = -carries * (push - centre[:, foot, 1] * spin)
        ground[:, 3 * foot + 1] = -carries * (lift + centre[:, foot, 0] * spin)
        ground[:, 3 * foot + 2] = -carries * _FOOT_ARM**2 * spin

    extra = np.empty((n, 6))
    for leg in range(2):
        force = ground[:, 3 * leg : 3 * leg + 2].copy()
        about = ground[:, 3 * leg + 2] + centre[:, leg, 0] * force[:, 1] - centre[:, leg, 1] * force[:, 0]
        for k in (2, 1, 0):
            row = 1 + 3 * leg + k
            force += wrench[:, row, :2]
            about = about + moment[:, row]
            joint = about_pelvis[:, row]
            extra[:, 3 * leg + k] = -(about - joint[:, 0] * force[:, 1] + joint[:, 1] * force[:, 0])
    return extra


def backpack_wrench(
    position: NDArray[np.float64],
    acceleration: NDArray[np.float64],
    place: tuple[float, float],
    mass: NDArray[np.float64],
    inertia: float,
) -> NDArray[np.float64]:
    """Return what the same payload, fixed to the wearer's back without the machine, does to each segment.

    Args:
        position: pelvis_x, pelvis_z [m] and torso_pitch [rad], their rates and (next argument) accelerations: columns
            0-2 position, 3-5 rate, shape (n, 6).
        acceleration: The second derivatives by time, shape (n, 3).
        place: Payload's mass centre in the torso, x and z from the hips [m].
        mass: Payload [kg], shape (n,).
        inertia: About its own mass centre, of each kilogram [m^2].

    Returns:
        Wrench on each segment about its upper joint, shape (n, 7, 3).
    """
    sine, cosine = np.sin(position[:, 2]), np.cos(position[:, 2])
    rx, rz = place[0] * cosine - place[1] * sine, place[0] * sine + place[1] * cosine
    turning, spin = acceleration[:, 2], position[:, 5] ** 2
    ax = acceleration[:, 0] - rz * turning - rx * spin
    az = acceleration[:, 1] + rx * turning - rz * spin
    fx, fz = -mass * ax, -mass * (az + GRAVITY)
    wrench = np.zeros((len(position), len(SEGMENTS), 3))
    wrench[:, 0] = np.stack([fx, fz, rx * fz - rz * fx - mass * inertia * turning], axis=1)
    return wrench
