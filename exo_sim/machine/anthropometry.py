"""The wearer's mass: segments of a body of given height and weight, and what moving and holding them asks.

Shares of body mass, centres of mass and radii of gyration are those of Winter (2009), Biomechanics and Motor Control of Human Movement,
4th edition, table 4.1 (after Dempster), head, arms and trunk as one segment from greater trochanter to shoulder.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.person import SEGMENTS, Person

GRAVITY = 9.81
#: Share of body mass: head, arms and trunk; thigh; shank; foot.
_MASS = (0.678, 0.100, 0.0465, 0.0145)
#: Centre of mass from the upper joint (of the trunk: from the hip), and radius of gyration about it, in segment lengths.
_CENTRE = (0.626, 0.433, 0.433, 0.50)
_GYRATION = (0.496, 0.323, 0.302, 0.475)
#: Hip (0.530) to shoulder (0.818), in body heights (the same book, figure 4.1).
_TRUNK = 0.288


@dataclass(frozen=True)
class Body:
    """Segments in the order of `person.SEGMENTS`.

    Attributes:
        mass: [kg], shape (7,).
        centre: Of mass in the segment, x and z from its upper joint (the trunk's: the hip) [m], shape (7, 2).
        inertia: About the centre of mass [kg m^2], shape (7,).
    """

    mass: NDArray[np.float64]
    centre: NDArray[np.float64]
    inertia: NDArray[np.float64]

    def place(self, angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return each centre of mass from its segment's upper joint, in space, for angles of shape (n, 7): shape (n, 7, 2)."""
        cosine, sine = np.cos(angle), np.sin(angle)
        x, z = self.centre[:, 0], self.centre[:, 1]
        return np.stack([x * cosine - z * sine, x * sine + z * cosine], axis=-1)


def body(person: Person) -> Body:
    """Return the segments of a person."""
    trunk = _TRUNK * person.height
    foot = float(np.hypot(person.toe, person.ankle_height))
    lengths = np.array([trunk, *[person.thigh, person.shank, foot] * 2])
    order = [0, 1, 2, 3, 1, 2, 3]
    mass = person.mass * np.array(_MASS)[order]
    along = lengths * np.array(_CENTRE)[order]
    centre = np.zeros((len(SEGMENTS), 2))
    centre[:, 1] = -along
    centre[0, 1] = along[0]
    centre[[3, 6]] = 0.5 * person.toe, -0.5 * person.ankle_height
    return Body(mass, centre, mass * (lengths * np.array(_GYRATION)[order]) ** 2)


def accelerations(curvature: NDArray[np.float64], poses: NDArray[np.float64], person: Person) -> NDArray[np.float64]:
    """Return how the segments' upper joints accelerate.

    Args:
        curvature: Second derivatives of `person.COORDINATES` by time, shape (n, 9).
        poses: From `segment_poses`, shape (n, 7, 6).
        person: Whose segments.

    Returns:
        x, z [m/s^2] and angle [rad/s^2] of each segment, shape (n, 7, 3).
    """
    out = np.empty((len(poses), len(SEGMENTS), 3))
    out[:, 0] = curvature[:, :3]
    lengths = (person.thigh, person.shank)
    for leg in range(2):
        x, z, turning = curvature[:, 0], curvature[:, 1], curvature[:, 2]
        for k in range(3):
            row = 1 + 3 * leg + k
            turning = turning + curvature[:, 3 + 3 * leg + k]
            out[:, row] = np.stack([x, z, turning], axis=1)
            if k < 2:
                angle, rate = poses[:, row, 2], poses[:, row, 5]
                s, c = lengths[k] * np.sin(angle), lengths[k] * np.cos(angle)
                x = x + c * turning - s * rate**2
                z = z + s * turning + c * rate**2
    return out


def body_wrench(poses: NDArray[np.float64], acceleration: NDArray[np.float64], person: Person) -> NDArray[np.float64]:
    """Return weight and inertia of the wearer's own segments as loads on them (d'Alembert).

    Args:
        poses: From `segment_poses`, shape (n, 7, 6).
        acceleration: From `accelerations`, shape (n, 7, 3).
        person: Whose segments.

    Returns:
        Force x, z [N] and moment about -y [N m] on each segment about its upper joint, shape (n, 7, 3).
    """
    it = body(person)
    arm = it.place(poses[:, :, 2])
    turning, spin = acceleration[:, :, 2], poses[:, :, 5] ** 2
    ax = acceleration[:, :, 0] - arm[:, :, 1] * turning - arm[:, :, 0] * spin
    az = acceleration[:, :, 1] + arm[:, :, 0] * turning - arm[:, :, 1] * spin
    fx, fz = -it.mass * ax, -it.mass * (az + GRAVITY)
    return np.stack([fx, fz, arm[:, :, 0] * fz - arm[:, :, 1] * fx - it.inertia * turning], axis=-1)


def energy(poses: NDArray[np.float64], person: Person) -> NDArray[np.float64]:
    """Return kinetic and potential energy of the wearer's own body [J], shape (n,), for poses of shape (n, 7, 6)."""
    it = body(person)
    arm = it.place(poses[:, :, 2])
    rate = poses[:, :, 5]
    vx, vz = poses[:, :, 3] - arm[:, :, 1] * rate, poses[:, :, 4] + arm[:, :, 0] * rate
    height = poses[:, :, 1] + arm[:, :, 1]
    return np.asarray(
        (0.5 * it.mass * (vx**2 + vz**2) + 0.5 * it.inertia * rate**2 + it.mass * GRAVITY * height).sum(axis=1)
    )
