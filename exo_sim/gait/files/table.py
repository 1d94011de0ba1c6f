"""Recordings of the contract and foreign tables (CSV, Parquet, .rrd): joint angles by column."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.labels import assigned
from exo_sim.gait.walking_trial import JOINTS, PELVIS, GroundForce, Trial
from exo_sim.recording import reader
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.table import Recording

#: What the wearer of a machine has otherwise called than a trial.
_WEARER = {"tilt": "pitch", "pelvis_x": "x", "pelvis_z": "z"}


def read_angles(path: Path, named: Mapping[str, str], columns: ColumnMap | None = None) -> tuple[Trial, GroundForce | None]:
    """Read the angles of a trial, and the ground forces that stand beside them.

    Raises:
        RecordingError: the file cannot be read.
        ScenarioError: an angle is missing or no angle.
    """
    reading = reader.read(path, columns)
    recording, guessed = reading.recording, {finding.column for finding in reading.findings if finding.kind == "unit"}
    places = {key.removesuffix(".position"): key for key in recording.columns if key.endswith(".position")}
    given = {name: places.get(label, label) for name, label in named.items()}
    own = wearer_columns(recording.columns, str(path), given)
    found = assigned(places.values(), str(path), {**own, **given})
    plain: list[str] = []
    for name, key in found.items():
        wanted = "m" if name in ("pelvis_x", "pelvis_z") else "rad"
        if recording.units[key] != wanted and key in guessed:  # a file of rerun that says none: nothing was converted
            plain.append(f"{key} [{wanted}]")
        elif recording.units[key] != wanted:
            raise ScenarioError(f'{path}: "{key}" is in {recording.units[key]}; {name} must be in {wanted}')
    said = f'{path}: no unit is said there, taken are {", ".join(plain)}; log a static component "unit" beside each to be sure'
    angles = {name: np.asarray(recording[key]) for name, key in found.items()}
    source = recording.metadata.get("source") or path.name
    remarks = [f"{path}: {finding.says}" for finding in reading.findings if finding.use == "repaired" and finding.severity != "info"]
    remarks += [said] if plain else []
    if own:
        remarks.append(f"{path}: recorded with a machine on; walked is what its wearer did (wearer_hip_l.position and so on)")
    trial = Trial(path.stem, str(path), recording.time, angles, source=source, remarks=tuple(remarks))
    return trial, _ground(recording, str(path))


def wearer_columns(columns: Iterable[str], file_name: str, given: Mapping[str, str]) -> dict[str, str]:
    """Return which columns are the angles of a machine's wearer, who does not move as the machine does; none where nobody wears one.

    Args:
        columns: Of the file.
        file_name: The file, for messages.
        given: Angles whose columns somebody has named.

    Raises:
        ScenarioError: what the wearer's joints gave is there, their angles are not.
    """
    columns = set(columns)
    own = {name: f"wearer_{_WEARER.get(name, name)}.position" for name in (*JOINTS, *PELVIS)}
    own = {name: key for name, key in own.items() if key in columns}
    if all(name in own for name in JOINTS):
        return own
    if any(key.endswith(".wearer_total_moment") for key in columns) and not all(name in given for name in JOINTS):
        raise ScenarioError(
            f"{file_name}: its hip_l.position is the machine's, and its wearer's wearer_hip_l.position is missing; "
            "hand in the gait that he walked by, or a recording of this version"
        )
    return {}


def read_ground(path: Path) -> GroundForce:
    """Read every column `<site>.ground_force_z`.

    Raises:
        RecordingError: the file cannot be read.
        ScenarioError: it holds no vertical ground force.
    """
    found = _ground(reader.read(path).recording, str(path))
    if found is None:
        raise ScenarioError(f"{path}: no column <site>.ground_force_z [N], as in foot_l.ground_force_z [N]")
    return found


def _ground(recording: Recording, file_name: str) -> GroundForce | None:
    """Return the force on each foot: on the wearer's own where a machine has feet, too."""
    kind = ".wearer_force_z" if any(key.endswith(".wearer_force_z") for key in recording.columns) else ".ground_force_z"
    up = {key: recording[key] for key in recording.columns if key.endswith(kind)}
    if not up:
        return None
    foot = {}
    for key in up:
        words = key.split(".")[0].lower().split("_")
        sides = [side for side, names in (("l", {"l", "left"}), ("r", {"r", "right"})) if set(words) & names]
        if len(sides) == 1:
            foot[key] = sides[0]
    return GroundForce(file_name, recording.time, up, foot)
