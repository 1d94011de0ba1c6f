"""A walking trial as somebody recorded it: joint angles of both legs over time, signs and zeros those of the machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Angles that a trial must have, in the order of the machine's joints.
JOINTS = ("hip_l", "knee_l", "ankle_l", "hip_r", "knee_r", "ankle_r")
#: Angles and places that it may have: pitch of the pelvis (a pelvis that leans forward is negative), its way forward and its height.
PELVIS = ("tilt", "pelvis_x", "pelvis_z")
#: What may stand in a trial beside its angles.
FORCES = ("force_l", "force_r")


@dataclass(frozen=True)
class Trial:
    """Angles on one clock.

    Attributes:
        name: What to call it: the file's name without its ending.
        file_name: The file, for messages.
        time: [s], strictly increasing, shape (n,).
        angles: `JOINTS` and, where it was recorded, "tilt": flexion of the hip, extension of the knee and dorsiflexion of the ankle are
            positive, straight is zero [rad], shape (n,) each. "pelvis_x" and "pelvis_z" [m] where they were recorded.
        contacts: Heel strikes of each foot that the file itself tells [s]: "l", "r".
        leaves: The same for toe-off.
        source: Words about where it comes from.
        remarks: Plain sentences: what was assumed or put right.
    """

    name: str
    file_name: str
    time: Array
    angles: Mapping[str, Array]
    contacts: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    leaves: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    source: str = ""
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class GroundForce:
    """Vertical forces of the ground, one column a plate or foot.

    Attributes:
        file_name: The file, for messages.
        time: [s], shape (n,).
        up: Label to force, up positive [N], shape (n,) each.
        foot: Label to "l" or "r", where the label tells the foot.
    """

    file_name: str
    time: Array
    up: Mapping[str, Array]
    foot: Mapping[str, str] = field(default_factory=dict)
