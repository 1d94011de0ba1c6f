"""Write a rig back with what was found of it, so that it reads as a diff against the owner's file.

Nothing of the owner's text moves: nominal numbers are replaced where they stand, with the old one and the interval in a comment, and
new tables go to the end.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import InlineTable, Item

from exo_sim.physics.declaration import Effect, declared
from exo_sim.rig.effect_text import (
    EffectEntry,
    amount,
    as_written,
    given_in,
    interval_text,
    key_of,
    quoted,
    readable,
    table_text,
    typed_unit,
    unit_of,
)
from exo_sim.rig.schema import EffectSetting, Rig

#: What stands above a table of which the one before it says the same.
_AGAIN = "As above."


@dataclass(frozen=True)
class Correction:
    """A nominal number that is off.

    Attributes:
        key: Where it stands, e.g. ("cylinders", "piston", "valve", "area") or ("bodies", "load", "mass").
        value: What it is, in SI.
        unit: The SI unit.
        interval: What holds it with 95 %, in SI; None where nothing says.
        believed: The old number in SI, for the comment where the rig file does not hold it (a mass of the MJCF, a default).
        note: What else the comment says: of a number that is no finding, why it changed.
    """

    key: tuple[str, ...]
    value: float
    unit: str
    interval: tuple[float, float] | None = None
    believed: float | None = None
    note: str = ""


def improved(rig: Rig, effects: Sequence[EffectEntry], corrections: Sequence[Correction], folder: Path) -> str:
    """Return the text of the rig with effects switched on and numbers corrected, for a file in `folder`.

    Keeps the owner's order, comments and units. An effect that says all that another of the owner's says (asymmetric friction,
    Coulomb friction) takes that one's place; so does the poorer of both where the owner's richer one is zero.
    """
    corrections = [each for one in corrections for each in _as_written(rig, one)]
    text = _written_into(tomlkit.parse(rig.text), rig, effects, corrections, folder)
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError:  # tables in braces, which no header may extend: give them headers first
        text = _written_into(_with_headers(rig.text), rig, effects, corrections, folder)
    return text


def _as_written(rig: Rig, correction: Correction) -> list[Correction]:
    """Return a correction for every key of the file that says what is corrected: a valve's size may stand as four areas, or as C."""
    part, *rest = correction.key
    if part != "cylinders" or rest[1:] != ["valve", "area"] or rest[0] not in rig.cylinders:
        return [correction]
    cylinder = rig.cylinders[rest[0]]
    if [key for key, _, _ in cylinder.valve.sizes] in ([], ["area"]):
        return [correction]
    out = []
    for key, value, unit in cylinder.valve.sizes:
        share = value / cylinder.valve_area
        ends = correction.interval and (share * correction.interval[0], share * correction.interval[1])
        out.append(replace(correction, key=("cylinders", rest[0], "valve", key), value=share * correction.value, unit=unit, interval=ends))
    return out


def _written_into(
    document: tomlkit.TOMLDocument,
    rig: Rig,
    effects: Sequence[EffectEntry],
    corrections: Sequence[Correction],
    folder: Path,
) -> str:
    _point_at_model(document, rig, folder)
    for correction in corrections:
        _correct(document, correction)
    new: list[str] = []
    said = ""
    for finding in effects:
        effect = declared()[finding.setting.name]
        if not _set_anew(document, effect, finding):
            absorbed = _absorb(document, rig, effect, finding)
            new.append(table_text(effect, replace(absorbed, says=_AGAIN) if said and absorbed.says == said else absorbed))
            said = absorbed.says
    text = tomlkit.dumps(document)
    return "\n".join([text.rstrip("\n") + "\n", *new]) if new else text


def _with_headers(text: str) -> tomlkit.TOMLDocument:
    """Return the file with `[effects.NAME.WHERE]` headers in place of whatever holds its effects."""
    document = tomlkit.parse(text)
    held = document["effects"].unwrap()
    del document["effects"]
    effects = tomlkit.table(is_super_table=True)
    for name, places in held.items():
        effects[name] = tomlkit.table(is_super_table=True)
        for where, values in places.items():
            effects[name][where] = tomlkit.item(values)  # type: ignore[index]
    document["effects"] = effects
    return document


def _point_at_model(document: tomlkit.TOMLDocument, rig: Rig, folder: Path) -> None:
    model = rig.model.resolve()
    if (folder / str(document["model"])).resolve() == model:
        return
    try:
        there = Path(os.path.relpath(model, folder.resolve())).as_posix()
    except ValueError:  # another drive
        there = model.as_posix()
    _replace(document, ("model",), there, "")


def _correct(document: tomlkit.TOMLDocument, correction: Correction) -> None:
    *place, name = correction.key
    correction = replace(correction, key=(*place, _key_in(document, place, name, name)))
    old = _find(document, correction.key)
    unit, scale = correction.unit, 1.0
    if isinstance(old, str) and (typed := typed_unit(old, correction.unit)):
        unit, scale = typed
    elif old is None:
        unit, scale = readable(correction.value, correction.unit)
    notes = []
    if old is not None:
        notes.append(f"was {quoted(old)}")
    elif correction.believed is not None:
        notes.append(f"was {quoted(amount(correction.believed, unit, scale))}")
    if correction.interval is not None:
        notes.append(interval_text(correction.interval, unit, scale))
    if correction.note:
        notes.append(correction.note)
    _replace(document, correction.key, amount(correction.value, unit, scale), "; ".join(notes))


def _set_anew(document: tomlkit.TOMLDocument, effect: Effect, finding: EffectEntry) -> bool:
    """Replace the numbers of an effect that the owner's file has at this place already; say whether it had."""
    setting = finding.setting
    place = _place(document, setting)
    if place is None:
        return False
    for parameter, value in given_in(effect, setting):
        key = _key_in(document, place, parameter.name, key_of(parameter, setting))
        unit, scale, written = as_written(parameter, value, setting)
        old = _find(document, (*place, key))
        if isinstance(old, str) and not parameter.choices and (typed := typed_unit(old, unit_of(parameter, setting))):
            unit, scale = typed
            written = amount(float(value), unit, scale)
        if old is not None and _plain(old) == written:
            continue
        notes = [f"was {quoted(old)}"] if old is not None else []
        if parameter.name in finding.intervals:
            notes.append(interval_text(finding.intervals[parameter.name], unit, scale))
        _replace(document, (*place, key), written, "; ".join(notes))
    return True


def _key_in(document: tomlkit.TOMLDocument, place: Sequence[str], name: str, new: str) -> str:
    """Return the key by which the owner's file calls a parameter, or `new`: the force of an effect on what turns may be called torque."""
    held = _find(document, place)
    names = (name, "torque") if place[0] == "effects" and name == "force" else (name,)
    return next((key for key in names if isinstance(held, Mapping) and key in held), new)


def _place(document: tomlkit.TOMLDocument, setting: EffectSetting) -> tuple[str, ...] | None:
    """Return where the effect's table stands in the owner's file; a column may be quoted or two keys."""
    for where in ((setting.where,), tuple(setting.where.split(".", 1))):
        path = ("effects", setting.name, *where)
        if isinstance(_find(document, path), Mapping):
            return path
    return None


def _absorb(document: tomlkit.TOMLDocument, rig: Rig, effect: Effect, finding: EffectEntry) -> EffectEntry:
    """Put an effect in the place of the owner's poorer form of it, or of a richer form that is zero in all, and remove that form."""
    where = finding.setting.where
    richer = [one.name for one in declared().values() if any(name == effect.name for name, _ in one.absorbs)]
    idle = [name for name in richer if (own := rig.effect(name, where)) and not any(own.parameters.values())]
    for name in (*(name for name, _ in effect.absorbs), *idle):
        if rig.effect(name, where) is None:
            continue
        finding = replace(finding, says=f"{finding.says} It takes the place of the former {name}.".strip())
        del document["effects"][name][where]  # type: ignore[union-attr,index]
        if not document["effects"][name]:  # type: ignore[index]
            del document["effects"][name]  # type: ignore[union-attr]
    return finding


def _plain(value: Any) -> Any:
    return value.unwrap() if hasattr(value, "unwrap") else value


def _find(document: Mapping[str, Any], key: Sequence[str]) -> Any:
    here: Any = document
    for part in key:
        if not isinstance(here, Mapping) or part not in here:
            return None
        here = here[part]
    return here


def _replace(document: tomlkit.TOMLDocument, key: Sequence[str], value: Any, note: str) -> None:
    """Put a value at a key, tables made on the way; the note goes at the end of its line, before the owner's own comment."""
    here: Any = document
    line: Any = None  # the outermost inline table on the way: a comment can only stand behind it
    for part in key[:-1]:
        if part not in here:
            here[part] = tomlkit.table(is_super_table=part != key[-2])
        here = here[part]
        if line is None and isinstance(here, InlineTable):
            line = here
    item = tomlkit.item(value)
    if note and line is None:
        before = here[key[-1]].trivia.comment.lstrip("# ") if isinstance(here.get(key[-1]), Item) else ""
        item.comment(f"{note} | {before}" if before else note)
        item.trivia.comment_ws = "  "
    here[key[-1]] = item
    if note and line is not None:
        before = line.trivia.comment.lstrip("# ")
        line.comment(f"{key[-1]} {note} | {before}" if before else f"{key[-1]} {note}")
