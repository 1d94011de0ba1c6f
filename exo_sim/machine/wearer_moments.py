"""What straps or a backpack do to the wearer: the moments that hip, knee and ankle must give in addition to those of the own body.

Whatever they impose must reach the ground through the wearer's own legs, as `ground_reaction` says. Beside the weight of the body it
is small, so that here it counts as linear: centres of pressure move, and reach no edge. `ground_reaction.hold` has the edges.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.anthropometry import GRAVITY as GRAVITY
from exo_sim.machine.ground_reaction import joint_moments, linear_ground, totals
from exo_sim.machine.person import SEGMENTS


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
    force, place, moment = linear_ground(poses, totals(poses, wrench), share, pressure_centre, ankle_height)
    return joint_moments(poses, wrench, force, place, moment)


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
