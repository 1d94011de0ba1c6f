"""Which angle a label of a motion file means: OpenSim's coordinates, the contract's columns, Plug-in Gait and plain words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from exo_sim.errors import ScenarioError, nearest
from exo_sim.gait.walking_trial import JOINTS, PELVIS

_PARTS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_LEFT, _RIGHT = {"l", "left", "lt", "li"}, {"r", "right", "rt", "re"}
_JOINTS = ("hip", "knee", "ankle")
#: Words of labels that are no flexion angle of hip, knee or ankle.
_OTHER = {
    "adduction", "abduction", "rotation", "inversion", "eversion", "moment", "moments", "torque", "force", "forces", "power", "powers",
    "velocity", "speed", "acceleration", "beta", "reserve", "demanded", "wearer", "external", "command", "pressure", "temperature",
    "frontal", "transverse", "y", "z", "tx", "ty", "tz", "x2", "subtalar", "mtp", "length", "choked", "gas", "used", "strap", "ab", "ad",
    "internal", "varus", "valgus", "reaction", "emg",
}  # fmt: skip
_TILT = {"tilt", "pitch"}


def meaning(label: str) -> str | None:
    """Return which of `trial.JOINTS` or `trial.PELVIS` a label names, or None.

    Understood are "hip_flexion_r", "/jointset/knee_l/knee_angle_l/value", "knee_l.position", "LKneeAngles", "Right ankle" and the like.
    """
    name = label.split("[", 1)[0].strip().rstrip("/")
    if name.endswith("/speed"):
        return None
    name = name.removesuffix("/value").rsplit("/", 1)[-1]
    words = [word.lower() for word in _PARTS.findall(_split_side(name))]
    found = set(words)
    if found & {"torso", "pelvis"} and not found & {"moment", "force", "velocity", "speed", "torque"}:
        if found & _TILT:
            return "tilt"
        if name in ("pelvis_tx", "torso_x.position", "pelvis_x", "pelvis_x.position"):
            return "pelvis_x"
        if name in ("pelvis_ty", "torso_z.position", "pelvis_z", "pelvis_z.position"):
            return "pelvis_z"
        return None
    joints = [joint for joint in _JOINTS if joint in found or f"{joint}s" in found]
    sides = [side for side, names in (("l", _LEFT), ("r", _RIGHT)) if found & names]
    if len(joints) != 1 or len(sides) != 1 or found & _OTHER:
        return None
    return f"{joints[0]}_{sides[0]}"


def _split_side(name: str) -> str:
    """Part a side's letter from the joint's name: "LKneeAngles", "rhip", "kneeR"."""
    name = re.sub(r"^([LRlr])(?=(?:[Hh]ip|[Kk]nee|[Aa]nkle|HIP|KNEE|ANKLE))", r"\1_", name)
    return re.sub(r"((?:[Hh]ip|[Kk]nee|[Aa]nkle|HIP|KNEE|ANKLE))([LRlr])(?![A-Za-z])", r"\1_\2", name)


def assigned(labels: Iterable[str], file_name: str, named: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return which column is which angle: `trial.JOINTS` and what there is of `trial.PELVIS`, to their labels.

    Args:
        labels: Of the file's columns.
        file_name: The file, for messages.
        named: Angle to label, as a `[gait]` table names it: it counts before all others.

    Raises:
        ScenarioError: an angle of a leg is missing, or two columns claim to be it.
    """
    labels = list(labels)
    found = dict(named or {})
    for name, label in found.items():
        if label not in labels:
            raise ScenarioError(f'{file_name}: there is no column "{label}" for {name}{nearest(label, labels)}')
    claimed: dict[str, list[str]] = {}
    for label in labels:
        if (angle := meaning(label)) is not None and angle not in found:
            claimed.setdefault(angle, []).append(label)
    for angle, claims in claimed.items():
        if len(claims) > 1:
            raise ScenarioError(
                f'{file_name}: "{claims[0]}" and "{claims[1]}" could both be {angle}; say which in a [gait] table: {angle} = "{claims[0]}"'
            )
        found[angle] = claims[0]
    missing = [name for name in JOINTS if name not in found]
    if missing:
        listed = ", ".join(labels[:8]) + (", ..." if len(labels) > 8 else "")
        raise ScenarioError(
            f"{file_name}: no column for {', '.join(missing)} (flexion angles of both legs are needed); name it in the [gait] table of a "
            f'scenario file: {missing[0]} = "..."; there is: {listed}'
        )
    return {name: found[name] for name in (*JOINTS, *PELVIS) if name in found}
