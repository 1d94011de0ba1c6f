"""The `[effects.NAME.WHERE]` tables of a rig, checked against what each effect declares of itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from exo_sim import signals, units
from exo_sim.errors import RigError, UnitError, near, nearest
from exo_sim.physics.declaration import Effect, Parameter, declared
from exo_sim.rig.schema import Cylinder, EffectSetting
from exo_sim.rig.table import Table

#: Findings of a diagnosis that correct a number of the rig; the number itself is what to change.
CALIBRATIONS = {
    "flow_capacity": "[cylinders.NAME.valve] area",
    "dead_volume": "[cylinders.NAME] dead_volume_1 and dead_volume_2",
    "payload_mass": "[bodies.NAME] mass",
    "joint_damping": "[joints.NAME] damping_factor",
    "joint_inertia": "[joints.NAME] inertia_factor",
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
            raise RigError(
                f"{table.path}: effects.{name} is a nominal number of the rig, not an effect: change {CALIBRATIONS[name]} itself"
            )
        if name not in known:
            own = "" if near(name, known) else "; one of your own is named in EXO_SIM_EFFECTS (docs/add_an_effect.md)"
            raise RigError(f"{table.path}: effects.{name} is not an effect{nearest(name, known)}{own}")
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
        if not isinstance(values, Mapping):
            raise RigError(f"{group.path}: {group.key}.{where} must be a table: write [{group.key}.WHERE] above its keys, "
                           f"WHERE being a {' or a '.join(effect.places)}")  # fmt: skip
        table = Table(group.path, f"{group.key}.{where}", values)
        nested = all(isinstance(value, Mapping) for value in table.values.values()) and table.values
        if "column" in effect.places and nested:
            places += [
                (f"{where}.{signal}", Table(group.path, f"{table.key}.{signal}", inner))
                for signal, inner in table.values.items()
            ]
        else:
            places.append((where, table))
    return places


def _setting(effect: Effect, where: str, table: Table, cylinders: Mapping[str, Cylinder]) -> EffectSetting:
    place = _place(effect, where, table, cylinders)
    if place == "cylinder":
        _check_part(effect, cylinders[where], table)
    parameters: dict[str, float] = {}
    curves: dict[str, tuple[float, ...]] = {}
    turning = False
    for parameter in effect.parameters:
        if parameter.most:
            curves[parameter.name], turns = _curve(parameter, parameters, place, table)
        else:
            value, turns = _value(effect, parameter, where, place, table)
            if value is not None:
                parameters[parameter.name] = value
        turning = turning or turns
    table.done()
    if effect.any_of and not any(all(name in parameters for name in names) for names in effect.any_of):
        ways = " or ".join(" and ".join(names) for names in effect.any_of)
        raise RigError(f"{table.path}: [{table.key}] needs {ways}")
    if place == "cylinder":
        _check_chambers(effect, cylinders[where], table)
    if effect.check is not None and (problem := effect.check(place, parameters, curves)):
        raise RigError(f"{table.path}: [{table.key}]: {problem}")
    return EffectSetting(effect.name, where, parameters, turning, curves)


def _check_part(effect: Effect, cylinder: Cylinder, table: Table) -> None:
    """Refuse what this cylinder has no part for: a valve's trouble without a valve, chamber 2's where there is none."""
    if effect.needs_valve and cylinder.valve_area <= 0.0:
        raise RigError(
            f"{table.path}: [{table.key}]: cylinder {cylinder.name} has no valve for {effect.name} to act in; "
            f"give it [cylinders.{cylinder.name}.valve] area, or remove the effect"
        )


def _check_chambers(effect: Effect, cylinder: Cylinder, table: Table) -> None:
    """Refuse what acts on the chamber 2 that a single-acting cylinder does not have."""
    if cylinder.single_acting:
        for parameter in effect.parameters:
            name = parameter.name
            if name in table.values and "_2" in (name[-2:], str(table.values[name])[-2:]):
                raise table.fail(
                    name, f"cylinder {cylinder.name} is single acting: its chamber 2 is the atmosphere; remove the key"
                )


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
        raise RigError(
            f'{table.path}: [{table.key}]: "{where}" is not a cylinder of this rig{nearest(where, cylinders)}'
        )
    if fixed:
        raise RigError(
            f"{table.path}: [{table.key}]: {effect.name} acts on {fixed[0]}: write [effects.{effect.name}.{fixed[0]}]"
        )
    if effect.places == ("column",):
        raise RigError(
            f"{table.path}: [{table.key}]: {effect.name} acts on one column: write "
            f'[effects.{effect.name}."{next(iter(cylinders), "slide")}.pressure_1"]'
        )
    raise RigError(
        f"{table.path}: [{table.key}]: {effect.name} cannot act on {_called(place, where)}; it acts on a {' or a '.join(effect.places)}"
    )


def _called(place: str, where: str) -> str:
    return f"the {where}" if place == where else f"{place} {where}"


def _value(effect: Effect, parameter: Parameter, where: str, place: str, table: Table) -> tuple[float | None, bool]:
    """Return a parameter in SI, and whether it was given for a part that turns."""
    key = parameter.name
    if key == "force" and place == "joint" and not table.has("force") and table.has("torque"):
        key = "torque"
    if key == "force" and place == "cylinder" and not table.has(key) and "torque" in table.values:
        raise RigError(f"{table.path}: {table.name('torque')}: {_slides(where, parameter)}")
    if not table.has(key):
        if parameter.required and not effect.any_of:
            raise RigError(f"{table.path}: {table.name(key)} is missing{_like(parameter, where, table)}")
        return (parameter.default if parameter.default else None), False
    raw = table.values[key]
    if parameter.choices:
        return float(parameter.choices.index(table.text(key, choices=parameter.choices))), False
    if parameter.unit == "column":
        wanted = _column_units(where, table)
    else:
        wanted = _units(parameter, place)
    try:
        value, unit = _parse(raw, wanted, table, key)
    except RigError:
        if place == "cylinder" and _is(raw, parameter.angular_unit):
            raise RigError(f'{table.path}: {table.name(key)} = "{raw}": {_slides(where, parameter)}') from None
        raise
    if not parameter.low <= value <= parameter.high:
        raise table.fail(key, f"is outside {parameter.low:g} to {parameter.high:g}{'' if unit == '1' else ' ' + unit}")
    return value, len(wanted) > 1 and unit == wanted[1]


def _is(raw: Any, unit: str | None) -> bool:
    try:
        return unit is not None and bool(units.parse(raw, unit) is not None)
    except UnitError:
        return False


def _slides(where: str, parameter: Parameter) -> str:
    return (
        f'"{where}" is a cylinder here, whose rod slides: give it like "1 {parameter.unit}"; '
        "where a joint of that name is meant, give the cylinder another name"
    )


def _like(parameter: Parameter, where: str, table: Table) -> str:
    if parameter.choices:
        return f"; there is: {', '.join(parameter.choices)}"
    unit = _column_units(where, table)[0] if parameter.unit == "column" else parameter.unit
    return ": give it like 0.1" if unit == "1" else f': give it like "1 {unit}"'


def _units(parameter: Parameter, place: str, choice: int = 0) -> list[str]:
    """Return the SI units that a parameter may have at this place: a joint's sliding one, then its turning one."""
    straight, turning = parameter.unit_at(False, choice), parameter.unit_at(True, choice)
    return [straight, turning] if place == "joint" and turning != straight else [straight]


def _curve(
    parameter: Parameter, parameters: Mapping[str, float], place: str, table: Table
) -> tuple[tuple[float, ...], bool]:
    """Return a list of numbers in SI, and whether it was given for a part that turns."""
    assert parameter.unit_by is not None
    choice = int(parameters.get(parameter.unit_by[0], 0.0))
    wanted = _units(parameter, place, choice)
    key = parameter.name
    if not table.has(key):
        raise RigError(f'{table.path}: {table.name(key)} is missing: give it like ["0 {wanted[0]}", "1 {wanted[0]}"]')
    raw = table.values[key]
    if not isinstance(raw, list):
        raise table.fail(key, f'must be a list, like ["0 {wanted[0]}", "1 {wanted[0]}"]')
    if not 2 <= len(raw) <= parameter.most:
        raise RigError(f"{table.path}: {table.name(key)} has {len(raw)} entries; it needs from 2 to {parameter.most}")
    read = [_parse(entry, wanted, table, key) for entry in raw]
    for value, unit in read:
        if not parameter.low <= value <= parameter.high:
            raise RigError(
                f"{table.path}: {table.name(key)}: {value:g} {unit} is outside {parameter.low:g} to {parameter.high:g} {unit}"
            )
        if unit != read[0][1]:
            raise RigError(
                f'{table.path}: {table.name(key)} mixes "{read[0][1]}" and "{unit}": a joint slides or turns'
            )
    return tuple(value for value, _ in read), len(wanted) > 1 and read[0][1] == wanted[1]


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
        for other, _ in effect.absorbs:
            if (other, where) in on:
                raise RigError(
                    f"{table.path}: [effects.{name}.{where}] and [effects.{other}.{where}] exclude each other: "
                    f"{name} says all that {other} says; keep one"
                )
