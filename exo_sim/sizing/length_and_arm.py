"""Length and moment arm of a cylinder between two points, in closed form (B24 of a crank, without its special cases).

A search asks for these of rods that are in no model yet; those of a compiled model are MuJoCo's (`exo_sim/machine/linkage.py`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.rig import Attachment


def length_and_arm(
    attachment: Attachment, across: float, angle: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return length and dlength/dangle at some joint angles.

    Args:
        attachment: Both ends from the joint's axis, all joints at zero [m]; the rod's end turns with the joint.
        across: Distance of the ends along the axis [m].
        angle: Of the joint, positive from x to z [rad], shape (n,).

    Returns:
        Length [m] and moment arm [m/rad], shape (n,) each; the arm is positive where pushing raises the angle.
    """
    (b_x, b_z), (r_x, r_z) = attachment.base, attachment.rod
    cos, sin = np.cos(angle), np.sin(angle)
    turned_x, turned_z = r_x * cos - r_z * sin, r_x * sin + r_z * cos
    length = np.sqrt((turned_x - b_x) ** 2 + (turned_z - b_z) ** 2 + across**2)
    # d(length^2)/dq = -2 base . d(turned)/dq, and d(turned)/dq is turned by a right angle
    arm = (b_x * turned_z - b_z * turned_x) / np.maximum(length, 1e-9)
    return length, arm
