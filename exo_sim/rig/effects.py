"""The `[effects.NAME.WHERE]` tables of a rig, checked against what each effect declares of itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from exo_sim import signals, units
from exo_sim.errors import RigError, UnitError, nearest
from exo_sim.physics.effects.declaration import Effect, Parameter, declared
from exo_sim.rig.schema import Cylinder, EffectSetting
from exo_sim.rig.table import Table

#: Findings of a diagnosis that correct a number of the rig; the number itself is what to change.
CALIBRATIONS = {
    "flow_capacity": "[cylinders.NAME.valve] area",
    "dead_volume": "[cylinders.NAME] dead_volume_1 and dead_volume_2",
    "payload_mass": "[bodies.NAME] mass",
}


def read_effects(table: Table | None, cylinders: Mapping[str, Cylinder]) -> tuple[EffectSetting, ...]:
    """Return every effect that the rig switches on.

    Raises:
        RigError: an unknown effect or place, a value outside its bounds, two effects that exclude each other.
    """
    if table is None:
        return ()
    known = declared()
    found = []
    for name in table.values:
        if name in CALIBRATIONS:
            raise RigError(f"{table.path}: effects.{name} is a believed number, not an effect: change {CALIBRATIONS[name]} itself")
        if name not in known:
            raise RigError(f"{table.path}: effects.{name} is not an effect{nearest(name, known)}")
        group = table.table(name)
        assert group is not None
        for where, values in _places(group, known[name]):
            found.append(_setting(known[name], where, values, cylinders))
    _check_together(table, known, found)
    return tuple(found)


def _places(group: Table, effect: Effect) -> list[tuple[str, Table]]:
    """Return (where, table) pairs; a column may be written `[effects.sensor_bias."piston.force"]` or without quotes."""
    places = []
    for where, values in group.values.items():
        table = Table(group.path, f"{group.key}.{where}", values)
        nested = all(isinstance(value, Mapping) for value in table.values.values()) and table.values
        if "column" in effect.places and nested:
            places += [(f"{where}.{signal}", Table(group.path, f"{table.key}.{signal}", inner)) for signal, inner in table.values.items()]
        else:
            places.append((where, table))
    return places


def _setting(effect: Effect, where: str, table: Table, cylinders: Mapping[str, Cylinder]) -> EffectSetting:
    place = _place(effect, where, table, cylinders)
    parameters: dict[str, float] = {}
    turning = False
    for parameter in effect.parameters:
        value, turns = _value(effect, parameter, where, place, table)
        if value is not None:
            parameters[parameter.name] = value
            turning = turning or turns
    table.done()
    if effect.any_of and not any(all(name in parameters for name in names) for names in effect.any_of):
        ways = " or ".join(" and ".join(names) for names in effect.any_of)
        raise RigError(f"{table.path}: [{table.key}] needs {ways}")
    return EffectSetting(effect.name, where, parameters, turning)


def _place(effect: Effect, where: str, table: Table, cylinders: Mapping[str, Cylinder]) -> str:
    if where in ("supply", "exhaust"):
        place = where
    elif where in cylinders:
        place = "cylinder"
    elif "." in where:
        place = "column"
    else:
        place = "joint"
    if place in effect.places:
        return place
    fixed = [name for name in effect.places if name in ("supply", "exhaust")]
    if "cylinder" in effect.places and place == "joint":
        raise RigError(f'{table.path}: [{table.key}]: "{where}" is not a cylinder of this rig{nearest(where, cylinders)}')
    if fixed:
        raise RigError(f"{table.path}: [{table.key}]: {effect.name} acts on {fixed[0]}: write [effects.{effect.name}.{fixed[0]}]")
    if effect.places == ("column",):
        raise RigError(
            f"{table.path}: [{table.key}]: {effect.name} acts on one column: write "
            f'[effects.{effect.name}."{next(iter(cylinders), "slide")}.pressure_1"]'
        )
    raise RigError(f"{table.path}: [{table.key}]: {effect.name} cannot act on {place} {where}; it acts on a {' or a '.join(effect.places)}")


def _value(effect: Effect, parameter: Parameter, where: str, place: str, table: Table) -> tuple[float | None, bool]:
    """Return a parameter in SI, and whether it was given for a part that turns."""
    key = parameter.name
    if key == "force" and place == "joint" and not table.has("force") and table.has("torque"):
        key = "torque"
    if not table.has(key):
        if parameter.required and not effect.any_of:
            raise RigError(f'{table.path}: {table.name(key)} is missing: give it like "1 {parameter.unit}"')
        return (parameter.default if parameter.default else None), False
    raw = table.values[key]
    if parameter.choices:
        return float(parameter.choices.index(table.text(key, choices=parameter.choices))), False
    wanted = [parameter.unit]
    if parameter.unit == "column":
        wanted = _column_units(where, table)
    elif place == "joint" and parameter.angular_unit:
        wanted = [parameter.unit, parameter.angular_unit]
    value, unit = _parse(raw, wanted, table, key)
    if not parameter.low <= value <= parameter.high:
        raise table.fail(key, f"is outside {parameter.low:g} to {parameter.high:g} {unit}")
    return value, unit == parameter.angular_unit


def _parse(raw: Any, wanted: list[str], table: Table, key: str) -> tuple[float, str]:
    problem: UnitError | None = None
    for unit in wanted:
        try:
            return units.parse(raw, unit), unit
        except UnitError as error:
            problem = problem or error
    raise RigError(f"{table.path}: {table.name(key)}: {problem}")


def _column_units(where: str, table: Table) -> list[str]:
    name = where.split(".", 1)[1]
    found = [unit for signal in signals.TABLE if signal.name == name for unit in signal.units]
    if not found:
        known = {signal.name for signal in signals.TABLE if signal.measured}
        raise RigError(f'{table.path}: [{table.key}]: "{name}" is not a signal{nearest(name, known)}')
    return list(dict.fromkeys(found))


def _check_together(table: Table, known: Mapping[str, Effect], found: list[EffectSetting]) -> None:
    on = {(setting.name, setting.where) for setting in found}
    for name, where in on:
        effect = known[name]
        if effect.requires and (effect.requires, where) not in on:
            raise RigError(f"{table.path}: [effects.{name}.{where}] needs [effects.{effect.requires}.{where}] as well")
        for other in effect.excludes:
            if (other, where) in on:
                raise RigError(f"{table.path}: [effects.{name}.{where}] and [effects.{other}.{where}] exclude each other: keep one")
