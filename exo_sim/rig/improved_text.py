"""Write a rig back with what was found of it, so that it reads as a diff against the owner's file.

Nothing of the owner's text moves: believed numbers are replaced where they stand, with the old one and the interval in a comment, and
new tables go to the end.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import InlineTable, Item, SingleKey

from exo_sim import signals, units
from exo_sim.physics.declaration import Effect, Parameter, declared
from exo_sim.rig.schema import EffectSetting, Rig

#: Units in which small numbers are read more easily, and below which SI number.
_READABLE = {"m": ("mm", 1e-3, 1.0), "m^2": ("mm^2", 1e-6, 1e-2), "m^3": ("cm^3", 1e-6, 1e-2), "s": ("ms", 1e-3, 1.0)}


@dataclass(frozen=True)
class EffectEntry:
    """An effect to switch on, or to set anew where the rig has it.

    Attributes:
        setting: The effect, its place and its numbers in SI.
        intervals: What holds each number with 95 %, in SI.
        says: A sentence for the comment above the table.
    """

    setting: EffectSetting
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    says: str = ""


@dataclass(frozen=True)
class Correction:
    """A believed number that is off.

    Attributes:
        key: Where it stands, e.g. ("cylinders", "piston", "valve", "area") or ("bodies", "load", "mass").
        value: What it is, in SI.
        unit: The SI unit.
        interval: What holds it with 95 %, in SI.
        believed: The old number in SI, for the comment where the rig file does not hold it (a mass of the MJCF, a default).
        note: What else the comment says.
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
    Coulomb friction) takes that one's numbers in and its place.
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
            new.append(table_text(effect, replace(absorbed, says="") if absorbed.says == said else absorbed))
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
    old = _find(document, correction.key)
    unit, scale = correction.unit, 1.0
    if isinstance(old, str) and (typed := _unit_of(old, correction.unit)):
        unit, scale = typed
    elif old is None:
        unit, scale = _readable(correction.value, correction.unit)
    notes = []
    if old is not None:
        notes.append(f"was {_quoted(old)}")
    elif correction.believed is not None:
        notes.append(f"was {_quoted(_amount(correction.believed, unit, scale))}")
    if correction.interval is not None:
        notes.append(_interval(correction.interval, unit, scale))
    if correction.note:
        notes.append(correction.note)
    _replace(document, correction.key, _amount(correction.value, unit, scale), "; ".join(notes))


def _set_anew(document: tomlkit.TOMLDocument, effect: Effect, finding: EffectEntry) -> bool:
    """Replace the numbers of an effect that the owner's file has at this place already; say whether it had."""
    setting = finding.setting
    place = _place(document, setting)
    if place is None:
        return False
    for parameter, value in _given(effect, setting):
        key = _key(parameter, setting)
        unit, scale, written = _written(parameter, value, setting)
        old = _find(document, (*place, key))
        if isinstance(old, str) and not parameter.choices and (typed := _unit_of(old, unit_of(parameter, setting))):
            unit, scale = typed
            written = _amount(float(value), unit, scale)
        if old is not None and _plain(old) == written:
            continue
        notes = [f"was {_quoted(old)}"] if old is not None else []
        if parameter.name in finding.intervals:
            notes.append(_interval(finding.intervals[parameter.name], unit, scale))
        _replace(document, (*place, key), written, "; ".join(notes))
    return True


def _place(document: tomlkit.TOMLDocument, setting: EffectSetting) -> tuple[str, ...] | None:
    """Return where the effect's table stands in the owner's file; a column may be quoted or two keys."""
    for where in ((setting.where,), tuple(setting.where.split(".", 1))):
        path = ("effects", setting.name, *where)
        if isinstance(_find(document, path), Mapping):
            return path
    return None


def _absorb(document: tomlkit.TOMLDocument, rig: Rig, effect: Effect, finding: EffectEntry) -> EffectEntry:
    """Take in what the owner's poorer form of this effect says, and remove that form."""
    for name, shares in effect.absorbs:
        held = rig.effect(name, finding.setting.where)
        if held is None:
            continue
        numbers, intervals = dict(finding.setting.parameters), dict(finding.intervals)
        for own, other in shares:
            more = held.parameters.get(other, 0.0)
            numbers[own] = numbers.get(own, 0.0) + more
            if own in intervals:
                intervals[own] = (intervals[own][0] + more, intervals[own][1] + more)
        says = f"{finding.says} It takes the place of the former {name}.".strip()
        finding = EffectEntry(replace(finding.setting, parameters=numbers), intervals, says)
        del document["effects"][name][finding.setting.where]  # type: ignore[union-attr,index]
        if not document["effects"][name]:  # type: ignore[index]
            del document["effects"][name]  # type: ignore[union-attr]
    return finding


def table_text(effect: Effect, finding: EffectEntry) -> str:
    """Return an effect's table as text, each number with its interval in a comment."""
    setting = finding.setting
    rows = []
    for parameter, value in _given(effect, setting):
        unit, scale, written = _written(parameter, value, setting)
        note = ""
        if parameter.name in finding.intervals:
            note = _interval(finding.intervals[parameter.name], unit, scale)
        rows.append((_key(parameter, setting), tomlkit.item(written).as_string(), note))
    names, values = (max(len(row[i]) for row in rows) for i in (0, 1))
    says = f"# {_one_line(finding.says)}\n" if finding.says else ""
    lines = [
        f"{key:{names}} = {value:{values}}  # {note}" if note else f"{key:{names}} = {value}"
        for key, value, note in rows
    ]
    head = f"[effects.{setting.name}.{SingleKey(setting.where).as_string()}]"
    return f"{says}{head}\n" + "".join(f"{line}\n" for line in lines)


def _given(effect: Effect, setting: EffectSetting) -> list[tuple[Parameter, Any]]:
    """Return the parameters that the setting holds, in the order of the declaration."""
    held = {**setting.parameters, **setting.curves}
    return [(parameter, held[parameter.name]) for parameter in effect.parameters if parameter.name in held]


def unit_of(parameter: Parameter, setting: EffectSetting) -> str:
    """Return the SI unit of a parameter at its place."""
    if parameter.unit == "column":
        part = [signal for signal in signals.TABLE if signal.name == setting.where.split(".", 1)[1]]
        return part[0].units[1 if setting.turning and len(part[0].units) > 1 else 0]
    choice = int(setting.parameters.get(parameter.unit_by[0], 0.0)) if parameter.unit_by else 0
    return parameter.unit_at(setting.turning, choice)


def _key(parameter: Parameter, setting: EffectSetting) -> str:
    return "torque" if parameter.name == "force" and setting.turning else parameter.name


def _written(parameter: Parameter, value: Any, setting: EffectSetting) -> tuple[str, float, Any]:
    """Return unit and scale for the comment, and what stands in the file."""
    if parameter.choices:
        return "1", 1.0, parameter.choices[int(value)]
    si = unit_of(parameter, setting)
    if parameter.most:
        unit, scale = _readable(max(map(abs, value)), si)
        return unit, scale, [_amount(entry, unit, scale) for entry in value]
    unit, scale = _readable(float(value), si)
    return unit, scale, _amount(float(value), unit, scale)


def _readable(value: float, si_unit: str) -> tuple[str, float]:
    unit, scale, below = _READABLE.get(si_unit, (si_unit, 1.0, 0.0))
    return (unit, scale) if 0.0 < abs(value) < below else (si_unit, 1.0)


def _unit_of(text: str, si_unit: str) -> tuple[str, float] | None:
    """Return unit and scale that the owner wrote, where it has no offset (not degrees Celsius)."""
    typed = units.split(text)[1]
    scale, offset = units.scale_and_offset(typed, si_unit)
    return (typed, scale) if offset == 0.0 else None


def _amount(value: float, unit: str, scale: float) -> str | float:
    number = float(f"{value / scale:.7g}")
    return number if unit in ("", "1") else f"{number:.7g} {unit}"


def _interval(interval: tuple[float, float], unit: str, scale: float) -> str:
    low, high = (bound / scale for bound in interval)
    digits = 4
    while digits < 12 and f"{low:.{digits}g}" == f"{high:.{digits}g}" and low != high:
        digits += 1
    return f"95 %: {low:.{digits}g} to {high:.{digits}g}{'' if unit in ('', '1') else ' ' + unit}"


def _quoted(value: Any) -> str:
    return _one_line(value.as_string() if isinstance(value, Item) else tomlkit.item(value).as_string())


def _one_line(text: str) -> str:
    return " ".join(str(text).split())


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
