"""An effect's table and its numbers as text of a rig file: units in which they are read easily, intervals in comments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import tomlkit
from tomlkit.items import Item, SingleKey

from exo_sim import signals, units
from exo_sim.physics.declaration import Effect, Parameter
from exo_sim.rig.schema import EffectSetting

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


def table_text(effect: Effect, finding: EffectEntry) -> str:
    """Return an effect's table as text, each number with its interval in a comment."""
    setting = finding.setting
    rows = []
    for parameter, value in given_in(effect, setting):
        unit, scale, written = as_written(parameter, value, setting)
        note = ""
        if parameter.name in finding.intervals:
            note = interval_text(finding.intervals[parameter.name], unit, scale)
        rows.append((key_of(parameter, setting), tomlkit.item(written).as_string(), note))
    names, values = (max(len(row[i]) for row in rows) for i in (0, 1))
    says = f"# {_one_line(finding.says)}\n" if finding.says else ""
    lines = [
        f"{key:{names}} = {value:{values}}  # {note}" if note else f"{key:{names}} = {value}"
        for key, value, note in rows
    ]
    head = f"[effects.{setting.name}.{SingleKey(setting.where).as_string()}]"
    return f"{says}{head}\n" + "".join(f"{line}\n" for line in lines)


def given_in(effect: Effect, setting: EffectSetting) -> list[tuple[Parameter, Any]]:
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


def key_of(parameter: Parameter, setting: EffectSetting) -> str:
    """Return the key of a parameter at its place: of a joint that turns, a force is a torque."""
    return "torque" if parameter.name == "force" and setting.turning else parameter.name


def as_written(parameter: Parameter, value: Any, setting: EffectSetting) -> tuple[str, float, Any]:
    """Return unit and scale for the comment, and what stands in the file for a value in SI."""
    if parameter.choices:
        return "1", 1.0, parameter.choices[int(value)]
    si = unit_of(parameter, setting)
    if parameter.most:
        unit, scale = readable(max(map(abs, value)), si)
        return unit, scale, [amount(entry, unit, scale) for entry in value]
    unit, scale = readable(float(value), si)
    return unit, scale, amount(float(value), unit, scale)


def readable(value: float, si_unit: str) -> tuple[str, float]:
    """Return the unit in which a number in SI is read easily, and what one of it is in SI."""
    unit, scale, below = _READABLE.get(si_unit, (si_unit, 1.0, 0.0))
    return (unit, scale) if 0.0 < abs(value) < below else (si_unit, 1.0)


def typed_unit(text: str, si_unit: str) -> tuple[str, float] | None:
    """Return unit and scale that the owner wrote, where it has no offset (not degrees Celsius)."""
    typed = units.split(text)[1]
    scale, offset = units.scale_and_offset(typed, si_unit)
    return (typed, scale) if offset == 0.0 else None


def amount(value: float, unit: str, scale: float) -> str | float:
    """Return what stands in the file for a number in SI: a quantity as text, or a bare number where it has no unit."""
    number = float(f"{value / scale:.7g}")
    return number if unit in ("", "1") else f"{number:.7g} {unit}"


def interval_text(interval: tuple[float, float], unit: str, scale: float) -> str:
    """Return the words for a 95 % interval in SI, with as many digits as tell its ends apart."""
    low, high = (bound / scale for bound in interval)
    digits = 4
    while digits < 12 and f"{low:.{digits}g}" == f"{high:.{digits}g}" and low != high:
        digits += 1
    return f"95 %: {low:.{digits}g} to {high:.{digits}g}{'' if unit in ('', '1') else ' ' + unit}"


def quoted(value: Any) -> str:
    """Return a value as a rig file has it, on one line."""
    return _one_line(value.as_string() if isinstance(value, Item) else tomlkit.item(value).as_string())


def _one_line(text: str) -> str:
    return " ".join(str(text).split())
