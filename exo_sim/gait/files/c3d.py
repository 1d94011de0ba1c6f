"""C3D files with joint angles, as Plug-in Gait and its like write them; read by ezc3d (the extra `c3d`)."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.files.c3d_content import Content, read_content
from exo_sim.gait.labels import assigned, meaning
from exo_sim.gait.walking_trial import GroundForce, Trial
from exo_sim.inputs import check_regular, refusing

#: What events of a C3D file are called.
_STRIKE, _OFF = {"foot strike", "heel strike", "initial contact"}, {"foot off", "toe off"}


def read_angles(path: Path, named: Mapping[str, str]) -> tuple[Trial, GroundForce | None]:
    """Read the sagittal angles of a trial (first component of each point of angles), its events and the vertical force of its plates.

    Plug-in Gait's pelvis leans forward positive: it is turned about. Heel strikes and toe-offs that the file marks are taken over.

    Raises:
        ScenarioError: ezc3d is not installed, the file is no C3D, or an angle is missing.
    """
    content = _read(path)
    labels = [label.strip() for label in content.labels]
    values, rate, first = content.points, content.rate, content.first_frame
    column = {label.rsplit(":", 1)[-1]: i for i, label in reversed(list(enumerate(labels)))}
    remarks: tuple[str, ...] = ()
    if content.refused:
        remarks = (f"{path}: its force plates are left aside, for ezc3d says: {content.refused}; hand in forces with --ground, if need be",)
    if not any(meaning(label) or label in named.values() for label in column):
        raise ScenarioError(
            f"{path}: it holds {len(labels)} points ({', '.join(labels[:4])}{', ...' if len(labels) > 4 else ''}) and no joint angles, as "
            "LHipAngles; markers are turned into angles by OpenSim's Inverse Kinematics, whose .mot is taken here (docs/your_gait.md)"
        )
    angle_like = [label for label in column if re.search(r"angle", label, re.IGNORECASE) or label in named.values()]
    pelvis = next((label for label in angle_like if re.fullmatch(r"[LR]?_?pelvis_?angles?", label, re.IGNORECASE)), None)
    found = assigned(angle_like or column, str(path), {**({"tilt": pelvis} if pelvis else {}), **named})
    factor = 1.0 if content.angle_unit.strip().lower().startswith("rad") else np.pi / 180.0
    angles = {}
    for name, label in found.items():
        if name not in ("pelvis_x", "pelvis_z"):
            seen = values[:, column[label]]
            angle = np.where(np.isnan(seen[0]) | (np.abs(seen).sum(axis=0) == 0.0), np.nan, factor * seen[0])
            angles[name] = -angle if name == "tilt" else angle
    time = (first + np.arange(values.shape[2])) / rate
    contacts, leaves = _events(content)
    return Trial(path.stem, str(path), time, angles, contacts, leaves, path.name, remarks), _plates(content, path)


def read_ground(path: Path) -> GroundForce:
    """Read the vertical force of every plate.

    Raises:
        ScenarioError: ezc3d is not installed, the file is no C3D, or it has no plates.
    """
    content = _read(path)
    found = _plates(content, path)
    if found is None:
        why = f" that are read: ezc3d says {content.refused}" if content.refused else ""
        raise ScenarioError(f"{path}: it holds no force plates{why}")
    return found


def _read(path: Path) -> Content:
    with refusing(lambda says: ScenarioError(f'"{path}": {says}')):
        check_regular(path)
    if importlib.util.find_spec("ezc3d") is None:
        raise ScenarioError(f'{path}: reading C3D needs ezc3d: pip install "exo-sim-pneumatic[c3d]"')
    with path.open("rb") as file:
        if file.read(2)[1:] != b"\x50":  # the format's own mark
            raise ScenarioError(f"{path}: it is not a C3D file")
    try:
        return read_content(path)
    except ValueError as error:
        raise ScenarioError(f"{path}: ezc3d cannot read it: {error}; copied in part? Copy it again") from None


def _events(content: Content) -> tuple[dict[str, tuple[float, ...]], dict[str, tuple[float, ...]]]:
    contacts: dict[str, list[float]] = {}
    leaves: dict[str, list[float]] = {}
    for (side, label), (minutes, seconds) in zip(content.events, content.event_times.T):
        foot, moment = side.strip().lower()[:1], 60.0 * float(minutes) + float(seconds)
        if foot in ("l", "r") and np.isfinite(moment):
            if label.strip().lower() in _STRIKE:
                contacts.setdefault(foot, []).append(moment)
            if label.strip().lower() in _OFF:
                leaves.setdefault(foot, []).append(moment)
    return {foot: tuple(sorted(t)) for foot, t in contacts.items()}, {foot: tuple(sorted(t)) for foot, t in leaves.items()}


def _plates(content: Content, path: Path) -> GroundForce | None:
    up, samples = {}, 0
    for i, force in enumerate(content.forces):
        if force.ndim == 2 and len(force) == 3 and np.isfinite(force[2]).any():
            up[f"plate {i + 1}"] = force[2] if np.nanmax(force[2]) > -np.nanmin(force[2]) else -force[2]
            samples = force.shape[1]
    if not up:
        return None
    analog = content.rate * samples / max(content.points.shape[2], 1)
    return GroundForce(str(path), content.first_frame / content.rate + np.arange(samples) / analog, up)
