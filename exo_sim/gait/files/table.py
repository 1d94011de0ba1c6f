"""Recordings of the contract and foreign tables (CSV, Parquet, .rrd): joint angles by column."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.labels import assigned
from exo_sim.gait.walking_trial import GroundForce, Trial
from exo_sim.recording import reader
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.table import Recording


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
    found = assigned(places.values(), str(path), given)
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
    repaired = (f"{path}: {finding.says}" for finding in reading.findings if finding.use == "repaired" and finding.severity != "info")
    remarks = (*repaired, *((said,) if plain else ()))
    trial = Trial(path.stem, str(path), recording.time, angles, source=source, remarks=remarks)
    return trial, _ground(recording, str(path))


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
    up = {key: recording[key] for key in recording.columns if key.endswith(".ground_force_z")}
    if not up:
        return None
    foot = {}
    for key in up:
        words = key.split(".")[0].lower().split("_")
        sides = [side for side, names in (("l", {"l", "left"}), ("r", {"r", "right"})) if set(words) & names]
        if len(sides) == 1:
            foot[key] = sides[0]
    return GroundForce(file_name, recording.time, up, foot)
