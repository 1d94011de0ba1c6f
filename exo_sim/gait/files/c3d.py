"""C3D files with joint angles, as Plug-in Gait and its like write them; read by ezc3d (the extra `c3d`)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.labels import assigned
from exo_sim.gait.trial import GroundForce, Trial
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
    point = content["parameters"]["POINT"]
    labels = [str(label).strip() for label in point["LABELS"]["value"]]
    values = np.asarray(content["data"]["points"], dtype=float)
    rate, first = float(point["RATE"]["value"][0]), int(content["header"]["points"]["first_frame"])
    column = {label.rsplit(":", 1)[-1]: i for i, label in reversed(list(enumerate(labels)))}
    angle_like = [label for label in column if re.search(r"angle", label, re.IGNORECASE) or label in named.values()]
    pelvis = next((label for label in angle_like if re.fullmatch(r"[LR]?_?pelvis_?angles?", label, re.IGNORECASE)), None)
    found = assigned(angle_like or column, str(path), {**({"tilt": pelvis} if pelvis else {}), **named})
    unit = str(point.get("ANGLE_UNITS", {"value": ["deg"]})["value"][0]).strip().lower()
    factor = 1.0 if unit.startswith("rad") else np.pi / 180.0
    angles = {}
    for name, label in found.items():
        if name not in ("pelvis_x", "pelvis_z"):
            seen = values[:3, column[label]]
            angle = np.where(np.isnan(seen[0]) | (np.abs(seen).sum(axis=0) == 0.0), np.nan, factor * seen[0])
            angles[name] = -angle if name == "tilt" else angle
    time = (first + np.arange(values.shape[2])) / rate
    contacts, leaves = _events(content["parameters"])
    return Trial(path.stem, str(path), time, angles, contacts, leaves, source=path.name), _plates(content, path, first, rate)


def read_ground(path: Path) -> GroundForce:
    """Read the vertical force of every plate.

    Raises:
        ScenarioError: ezc3d is not installed, the file is no C3D, or it has no plates.
    """
    content = _read(path)
    rate, first = float(content["parameters"]["POINT"]["RATE"]["value"][0]), int(content["header"]["points"]["first_frame"])
    found = _plates(content, path, first, rate)
    if found is None:
        raise ScenarioError(f"{path}: it holds no force plates")
    return found


def _read(path: Path) -> Any:
    with refusing(lambda says: ScenarioError(f'"{path}": {says}')):
        check_regular(path)
    try:
        import ezc3d
    except ImportError:
        raise ScenarioError(f'{path}: reading C3D needs ezc3d: pip install "exo-sim-pneumatic[c3d]"') from None
    if path.read_bytes()[1:2] != b"\x50":  # the format's own mark; the library ends the process on some other files
        raise ScenarioError(f"{path}: it is not a C3D file")
    try:
        return ezc3d.c3d(str(path), extract_forceplat_data=_has_plates(ezc3d, path))
    except Exception as error:
        raise ScenarioError(f"{path}: ezc3d cannot read it: {error}") from None


def _has_plates(ezc3d: Any, path: Path) -> bool:
    plain = ezc3d.c3d(str(path))
    used = plain["parameters"].get("FORCE_PLATFORM", {}).get("USED", {"value": [0]})["value"]
    return bool(len(used) and used[0] > 0)


def _events(parameters: Any) -> tuple[dict[str, tuple[float, ...]], dict[str, tuple[float, ...]]]:
    contacts: dict[str, list[float]] = {}
    leaves: dict[str, list[float]] = {}
    event = parameters.get("EVENT", {})
    if all(key in event for key in ("CONTEXTS", "LABELS", "TIMES")):
        times = np.asarray(event["TIMES"]["value"], dtype=float)
        for i, (side, label) in enumerate(zip(event["CONTEXTS"]["value"], event["LABELS"]["value"])):
            foot = str(side).strip().lower()[:1]
            if foot in ("l", "r") and times.ndim == 2 and i < times.shape[1]:
                moment = 60.0 * float(times[0, i]) + float(times[1, i])
                if str(label).strip().lower() in _STRIKE:
                    contacts.setdefault(foot, []).append(moment)
                if str(label).strip().lower() in _OFF:
                    leaves.setdefault(foot, []).append(moment)
    return {foot: tuple(sorted(t)) for foot, t in contacts.items()}, {foot: tuple(sorted(t)) for foot, t in leaves.items()}


def _plates(content: Any, path: Path, first: int, rate: float) -> GroundForce | None:
    plates = content["data"].get("platform", [])
    if not plates:
        return None
    up, samples = {}, 0
    for i, plate in enumerate(plates):
        force = np.asarray(plate["force"], dtype=float)[2]
        up[f"plate {i + 1}"] = force if np.nanmax(force) > -np.nanmin(force) else -force
        samples = len(force)
    analog = rate * samples / max(content["data"]["points"].shape[2], 1)
    return GroundForce(str(path), first / rate + np.arange(samples) / analog, up)
