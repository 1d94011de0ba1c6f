"""The wearer as a planar chain of rigid segments whose motion is prescribed.

Coordinates, in this order everywhere (the machine's joints have the same order and signs):
`pelvis_x`, `pelvis_z` [m], `torso_pitch`, `hip_l`, `knee_l`, `ankle_l`, `hip_r`, `knee_r`, `ankle_r` [rad].
x points forward, z up. Every rotation is about -y, so that hip flexion, knee extension and ankle dorsiflexion are
positive and a torso that leans forward has a negative pitch. An upright stance is all zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ScenarioError
from exo_sim.physics.compiled import kernel

COORDINATES = (
    "pelvis_x",
    "pelvis_z",
    "torso_pitch",
    "hip_l",
    "knee_l",
    "ankle_l",
    "hip_r",
    "knee_r",
    "ankle_r",
)
SEGMENTS = ("torso", "thigh_l", "shank_l", "foot_l", "thigh_r", "shank_r", "foot_r")
#: Index of the first coordinate of each leg.
LEG_START = {"l": 3, "r": 6}

#: The body height that the lengths below belong to [m].
REFERENCE_HEIGHT = 1.70

_THIGH, _SHANK, _ANKLE, _HEEL, _TOE = 0.440, 0.369, 0.070, -0.048, 0.137


@dataclass(frozen=True)
class Person:
    """Body height [m] and mass [kg]; segment lengths grow with height in proportion.

    Raises:
        ScenarioError: height outside 1.4 to 2.1 m, or mass outside 35 to 150 kg.
    """

    height: float = REFERENCE_HEIGHT
    mass: float = 75.0

    def __post_init__(self) -> None:
        if not 1.4 <= self.height <= 2.1:
            raise ScenarioError(f"wearer: height = {self.height:g} m is outside 1.4 to 2.1 m; write what the frame fits")
        if not 35.0 <= self.mass <= 150.0:
            raise ScenarioError(f"wearer: mass = {self.mass:g} kg is outside 35 to 150 kg; write one of those")

    @property
    def scale(self) -> float:
        """Lengths relative to the reference body."""
        return self.height / REFERENCE_HEIGHT

    @property
    def thigh(self) -> float:
        """Hip to knee [m]."""
        return _THIGH * self.scale

    @property
    def shank(self) -> float:
        """Knee to ankle [m]."""
        return _SHANK * self.scale

    @property
    def ankle_height(self) -> float:
        """Ankle above the sole [m]."""
        return _ANKLE * self.scale

    @property
    def heel(self) -> float:
        """Heel contact ahead of the ankle [m], negative."""
        return _HEEL * self.scale

    @property
    def toe(self) -> float:
        """Ball of the foot ahead of the ankle [m]."""
        return _TOE * self.scale

    def lengths(self) -> NDArray[np.float64]:
        """Return thigh, shank, ankle height, heel, toe [m], shape (5,): what the compiled kernels take."""
        return np.array([self.thigh, self.shank, self.ankle_height, self.heel, self.toe])


def leg_points(
    thigh: NDArray[np.float64], knee: NDArray[np.float64], ankle: NDArray[np.float64], person: Person
) -> dict[str, NDArray[np.float64]]:
    """Place one leg's points relative to the hip joint.

    Args:
        thigh: Angle of the thigh in space [rad], shape (n,): torso pitch plus hip angle.
        knee: Knee angle [rad], shape (n,).
        ankle: Ankle angle [rad], shape (n,).
        person: Whose segments.

    Returns:
        "knee", "ankle", "heel", "toe": x and z [m], each of shape (n, 2); "foot_angle" [rad], shape (n,).
    """

    def below(angle: NDArray[np.float64], length: float) -> NDArray[np.float64]:
        return length * np.stack([np.sin(angle), -np.cos(angle)], axis=-1)

    def ahead(angle: NDArray[np.float64], length: float) -> NDArray[np.float64]:
        return length * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    knee_point = below(thigh, person.thigh)
    ankle_point = knee_point + below(thigh + knee, person.shank)
    foot = thigh + knee + ankle
    sole = ankle_point + below(foot, person.ankle_height)
    return {
        "knee": knee_point,
        "ankle": ankle_point,
        "heel": sole + ahead(foot, person.heel),
        "toe": sole + ahead(foot, person.toe),
        "foot_angle": foot,
    }


@kernel
def segment_poses(
    q: NDArray[np.float64], v: NDArray[np.float64], lengths: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """Place every segment and give it its velocity.

    Args:
        q, v: Coordinates and their rates, shape (9,), order `COORDINATES`.
        lengths: `Person.lengths()`, shape (5,).
        out: Written: x, z [m], angle [rad], and their rates, of each of `SEGMENTS` at its upper joint, shape (7, 6).
    """
    for j in range(3):
        out[0, j] = q[j]
        out[0, 3 + j] = v[j]
    for leg in range(2):
        first = 3 + 3 * leg
        row = 1 + 3 * leg
        x, z, angle = q[0], q[1], q[2]
        vx, vz, rate = v[0], v[1], v[2]
        for k in range(3):
            angle += q[first + k]
            rate += v[first + k]
            out[row + k, 0], out[row + k, 1], out[row + k, 2] = x, z, angle
            out[row + k, 3], out[row + k, 4], out[row + k, 5] = vx, vz, rate
            if k < 2:
                s, c = lengths[k] * math.sin(angle), lengths[k] * math.cos(angle)
                x, z = x + s, z - c
                vx, vz = vx + c * rate, vz + s * rate


@kernel
def _poses_along(q: NDArray[np.float64], v: NDArray[np.float64], lengths: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    for i in range(q.shape[0]):
        segment_poses(q[i], v[i], lengths, out[i])


def poses_along(q: NDArray[np.float64], v: NDArray[np.float64], person: Person) -> NDArray[np.float64]:
    """Return `segment_poses` of many coordinates and rates, shape (n, 9) each: shape (n, 7, 6)."""
    out = np.empty((len(q), len(SEGMENTS), 6))
    _poses_along(np.ascontiguousarray(q), np.ascontiguousarray(v), person.lengths(), out)
    return out


@kernel
def pose_bodies(
    poses: NDArray[np.float64],
    offset_y: NDArray[np.float64],
    mocap_pos: NDArray[np.float64],
    mocap_quat: NDArray[np.float64],
) -> None:
    """Move the person's visible bodies to their segments.

    Args:
        poses: From `segment_poses`, shape (7, 6).
        offset_y: Where each segment is sideways [m], shape (7,).
        mocap_pos, mocap_quat: Of MuJoCo's data in the order of `SEGMENTS`, shapes (7, 3) and (7, 4); written.
    """
    for i in range(poses.shape[0]):
        mocap_pos[i, 0], mocap_pos[i, 1], mocap_pos[i, 2] = poses[i, 0], offset_y[i], poses[i, 1]
        half = 0.5 * poses[i, 2]
        mocap_quat[i, 0], mocap_quat[i, 1], mocap_quat[i, 2], mocap_quat[i, 3] = (
            math.cos(half),
            0.0,
            -math.sin(half),
            0.0,
        )
