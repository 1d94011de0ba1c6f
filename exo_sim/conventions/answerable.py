"""Which questions a recording can answer at all: of every effect and place, what must be recorded for it and is not.

Read from what each effect declares (`reveals`, `needs`, `identification.applicability`). That a question can be asked does not say that
its answer is large enough to show: that is for the diagnosis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from exo_sim.conventions.fed_chambers import fed_cylinders
from exo_sim.conventions.undriven import is_undriven
from exo_sim.machine.linkage import linkages
from exo_sim.machine.unmeasured_contact import without_ground_force
from exo_sim.physics.declaration import Effect, declared
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

#: What effects of a valve need: of a valve for each chamber the commands of both.
_COMMAND = "valve_command"

#: Ranges below which a joint did not move [m or rad], and a valve was not opened [1].
_STILL, _CLOSED = 1e-4, 0.01


@dataclass(frozen=True)
class Question:
    """One effect at one place.

    Attributes:
        effect, where: As in `[effects.NAME.WHERE]`.
        missing: What is not recorded, or did not happen, in words; empty where the question can be asked.
    """

    effect: str
    where: str
    missing: tuple[str, ...]

    @property
    def answerable(self) -> bool:
        """Whether the recording can answer it at all."""
        return not self.missing

    def as_dict(self) -> dict[str, Any]:
        """Return what `inspect --json` lists under `questions`."""
        return {"effect": self.effect, "where": self.where, "answerable": self.answerable, "missing": list(self.missing)}


def questions(recording: Recording, rig: Rig, model: mujoco.MjModel) -> list[Question]:
    """Return every effect at every place of a machine, with what the recording lacks for it.

    A joint and a cylinder of one name are one place: its question can be asked where it can be asked of either.

    Raises:
        ModelError: the model lacks a part of the rig.
    """
    joints = {link.cylinder: model.joint(int(model.dof_jntid[link.dof])).name for link in linkages(rig, model)}
    fed, found = fed_cylinders(recording, rig, model), []
    for effect in declared().values():
        if effect.cut in ("sensor", "any") or effect.identification.excluded:
            continue
        places = effect.identification.applicability.places or effect.places
        if "cylinder" in places:
            found += [_at_cylinder(effect, name, joints.get(name, ""), recording, rig, name in fed) for name in rig.cylinders]
        if "joint" in places:
            names = [model.joint(i).name for i in range(model.njnt)]
            found += [_at_joint(effect, name, [c for c, j in joints.items() if j == name], recording, rig) for name in names]
        found += [_shared(effect, place, recording, rig) for place in places if place in ("supply", "exhaust")]
    if unknown := _unknown_contact(recording, model):
        of_motion = {effect.name for effect in declared().values() if effect.cut == "motion"}
        cells = {name for name in rig.cylinders if f"{name}.force" in recording}
        found = [
            replace(one, missing=(*one.missing, unknown)) if one.effect in of_motion and one.where not in cells else one for one in found
        ]
    best: dict[tuple[str, str], Question] = {}
    for one in found:
        key = (one.effect, one.where)
        best[key] = min(best.get(key, one), one, key=lambda question: len(question.missing))
    return list(best.values())


def _at_cylinder(effect: Effect, name: str, joint: str, recording: Recording, rig: Rig, is_fed: bool) -> Question:
    cylinder, missing = rig.cylinders[name], []
    keys = {"position": f"{joint}.position"}
    commands = [f"{name}.{command}" for command in cylinder.needed_commands]
    if effect.needs_valve and cylinder.valve_area <= 0.0:
        missing.append(f"{name} has no valve")
    if effect.identification.applicability.two_chambers and cylinder.single_acting:
        missing.append(f"{name} has one chamber")
    wanted = [keys.get(signal, f"{name}.{signal}") for signal in effect.needs if signal != _COMMAND]
    if _COMMAND in effect.needs:
        wanted += commands
    if effect.cut == "gas":
        wanted.append(keys["position"])
        if cylinder.valve_area > 0.0:
            wanted += commands
    shown = [signal if "." in signal else keys.get(signal, f"{name}.{signal}") for signal in effect.reveals]
    missing += _lacking(recording, wanted, shown)
    if effect.cut == "gas" and is_fed:
        missing.append(f"a command of what lets gas into {name}")
    if effect.cut == "motion" and f"{name}.force" not in recording and not _drive_is_recorded(recording, joint, [name]):
        missing.append(f"{name}.pressure_1, {name}.force or {joint}.external_force, one of them")
    happened = _happened(effect, recording, commands, keys["position"])
    return Question(effect.name, name, (*dict.fromkeys(missing), *happened))


def _at_joint(effect: Effect, joint: str, cylinders: Sequence[str], recording: Recording, rig: Rig) -> Question:
    missing = _lacking(recording, [f"{joint}.position"], [])
    if not _drive_is_recorded(recording, joint, cylinders) and not _pushed(recording) and not is_undriven(recording, rig):
        drives = [f"{joint}.external_force", *(f"{name}.pressure_1" for name in cylinders)]
        missing.append(" or ".join(drives))
    return Question(effect.name, joint, (*dict.fromkeys(missing), *_happened(effect, recording, (), f"{joint}.position")))


def _shared(effect: Effect, place: str, recording: Recording, rig: Rig) -> Question:
    shown = [key for signal in effect.reveals for key in ([signal] if "." in signal else [f"{name}.{signal}" for name in rig.cylinders])]
    missing = _lacking(recording, [], shown)
    commands = [f"{name}.{command}" for name, cylinder in rig.cylinders.items() for command in cylinder.commands]
    if effect.identification.applicability.commanded and not any(_range(recording, key) > _CLOSED for key in commands):
        missing.append("a valve that opens, with its command recorded")
    return Question(effect.name, place, tuple(missing))


def _lacking(recording: Recording, wanted: Sequence[str], one_of: Sequence[str]) -> list[str]:
    missing = [key for key in dict.fromkeys(wanted) if key not in recording]
    if one_of and not any(key in recording for key in one_of):
        missing.append(" or ".join(one_of))
    return missing


def _drive_is_recorded(recording: Recording, joint: str, cylinders: Sequence[str]) -> bool:
    return f"{joint}.external_force" in recording or any(f"{name}.pressure_1" in recording for name in cylinders)


def _pushed(recording: Recording) -> bool:
    """Return whether forces of straps or of the ground on the machine were recorded."""
    return any(key.rsplit(".", 1)[-1].startswith(("strap_force_", "ground_force_")) for key in recording.columns)


def _unknown_contact(recording: Recording, model: mujoco.MjModel) -> str:
    """Return which column would tell what the ground does to a machine that stands on it, or ""."""
    names = {key.rsplit(".", 1)[0] for key in recording.columns if ".ground_force_" in key}
    sites = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name) for name in sorted(names)]
    body = without_ground_force(model, [site for site in sites if site >= 0])
    if not body:
        return ""
    there = [model.site(i).name for i in range(model.nsite) if model.body(int(model.site_bodyid[i])).name == body]
    site = body if body in there or not there else there[0]
    return f"{site}.ground_force_x and _z ({body} touches the ground)"


def _happened(effect: Effect, recording: Recording, commands: Sequence[str], position: str) -> list[str]:
    """Return what must have happened for the question to make sense, and did not."""
    sense, lacking = effect.identification.applicability, []
    valve = effect.needs_valve or sense.commanded
    recorded = [command for command in commands if command in recording]
    if valve and recorded and all(_range(recording, command) <= _CLOSED for command in recorded):
        lacking.append("the valve never opens")
    if (sense.moving or effect.cut == "motion") and position in recording and _range(recording, position) <= _STILL:
        lacking.append(f"{position.rsplit('.', 1)[0]} never moves")
    return lacking


def _range(recording: Recording, key: str) -> float:
    values = recording.get(key)
    if values is None or not np.isfinite(values).any():
        return 0.0
    return float(np.nanmax(values) - np.nanmin(values)) if ".valve_command" not in key else float(np.nanmax(np.abs(values)))
