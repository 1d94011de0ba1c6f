"""OpenSim's motions (`.mot`, `.sto`): joint angles as its inverse kinematics writes them, ground forces as it takes them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.labels import assigned
from exo_sim.gait.walking_trial import GroundForce, Trial
from exo_sim.recording.opensim_table import read_storage

#: An angle beyond this many radian is in degrees.
_TURN = 2.0 * np.pi
_VERTICAL = re.compile(r"^(?P<plate>.*?)(?:force|grf|GRF|F)(?P<side>[_.](?:l|r|left|right))?[_.]?(?:v|f)?y(?P<rest>.*)$")


def read_angles(path: Path, named: Mapping[str, str]) -> Trial:
    """Read the angles of a trial; `pelvis_tilt` counts as OpenSim's models have it (backward positive), as the machine's torso does.

    Raises:
        RecordingError: the file is not whole.
        ScenarioError: an angle is missing, or the header says radian where the numbers are degrees.
    """
    table = read_storage(path)
    columns = assigned(table.columns, str(path), named)
    angles = {
        name: table.columns[label] if name in ("pelvis_x", "pelvis_z") else table.angle(label) for name, label in columns.items()
    }
    for name, label in columns.items():
        most = float(np.nanmax(np.abs(angles[name]), initial=0.0))
        if name not in ("pelvis_x", "pelvis_z") and most > _TURN and not table.in_degrees:
            raise ScenarioError(
                f'{path}: "{label}" reaches {most:.0f} rad: the header does not say inDegrees=yes; write it there if the angles are degrees'
            )
    return Trial(path.stem, str(path), table.time, angles, source=f"{table.name} ({path.name})")


def read_ground(path: Path) -> GroundForce:
    """Read the vertical force of every plate (`ground_force_vy`, `1_ground_force_vy`, `ground_force_r_vy` and their like).

    Raises:
        RecordingError: the file is not whole.
        ScenarioError: it holds no vertical force.
    """
    table = read_storage(path)
    up, foot = {}, {}
    for label, values in table.columns.items():
        if (match := _VERTICAL.match(label)) is None or "torque" in label or "moment" in label or label.endswith("py"):
            continue
        up[label] = values
        words = set(re.split(r"[_.\d]+", f"{match['plate']}_{match['side'] or ''}_{match['rest']}".lower()))
        sides = [side for side, names in (("l", {"l", "left"}), ("r", {"r", "right"})) if words & names]
        if len(sides) == 1:
            foot[label] = sides[0]
    if not up:
        raise ScenarioError(f"{path}: no vertical ground force; its label ends in force_vy, as in ground_force_vy")
    return GroundForce(str(path), table.time, up, foot)
