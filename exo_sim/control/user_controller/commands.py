"""What a controller returned, read as commands to valves or as torques of joints."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.user_controller.protocol import Context
from exo_sim.errors import ScenarioError, nearest

VALVES, TORQUES = "valves", "torques"
_COMMAND, _TORQUE = ".valve_command", ".torque"
#: Of a valve with independent edges: the command towards each chamber.
_FIRST, _SECOND = ".valve_command_1", ".valve_command_2"


@dataclass(frozen=True)
class Commands:
    """What came back from `act`.

    Attributes:
        kind: `VALVES` or `TORQUES`.
        values: One a cylinder or joint, in the order of the context; where a valve has independent edges, the commands towards
            chambers 2 behind those towards chambers 1.
    """

    kind: str
    values: NDArray[np.float64]


def read(returned: Any, context: Context, kind: str = "") -> Commands:
    """Return what `act` returned as commands.

    Args:
        returned: A dictionary, or numbers in the order of the cylinders.
        context: Whose names count.
        kind: What it returned before, `VALVES` or `TORQUES`; "" at first.

    Raises:
        ScenarioError: a name that is no cylinder or joint, both kinds at once, a number that is none.
    """
    if isinstance(returned, Commands):
        return returned
    if isinstance(returned, Mapping):
        return _named(returned, context, kind)
    if returned is None:
        raise ScenarioError('act returned nothing; return commands like {"knee_l": 0.5}, or {} to close all valves')
    try:
        values = np.atleast_1d(np.asarray(returned, dtype=np.float64))
    except (TypeError, ValueError):
        raise ScenarioError(f'act returned a {type(returned).__name__}; return a dictionary like {{"knee_l": 0.5}}') from None
    if values.shape != (len(context.cylinders),):
        raise ScenarioError(
            f"act returned {values.size} numbers; without names they are valve commands, one each for {', '.join(context.cylinders)}"
        )
    return _to_valves(dict(zip(context.cylinders, values.tolist())), context)


def _named(returned: Mapping[Any, Any], context: Context, kind: str) -> Commands:
    found = ""
    values: dict[str, float] = {}
    for key, value in returned.items():
        one, name = _meant(str(key), context)
        if found and one != found:
            raise ScenarioError(f'"{key}" asks for a {_said(one)}, the others are {_said(found)}s; return one kind')
        found = one
        try:
            values[name] = float(value)
        except (TypeError, ValueError):
            raise ScenarioError(f'"{key}" is a {type(value).__name__}, not a number') from None
    found = found or kind or VALVES
    names = context.cylinders if found == VALVES else context.joints
    if found == VALVES:
        return _to_valves({**values, **{name: values[name + _FIRST] for name in names if name + _FIRST in values}}, context)
    out = np.array([values.get(name, 0.0) for name in names])
    _check_finite(out, names)
    return Commands(found, out)


def _to_valves(values: Mapping[str, float], context: Context) -> Commands:
    """Return the commands of all valves; one command for a valve with independent edges moves both sides as a 4-way valve would."""
    out = np.array([values.get(name, 0.0) for name in context.cylinders])
    if any(cylinder.valve.independent for cylinder in context.rig.cylinders.values()):
        other = [
            values.get(name + _SECOND, 0.0 if name + _FIRST in values else -values.get(name, 0.0)) for name in context.cylinders
        ]
        out = np.concatenate([out, other])
    _check_finite(out, context.cylinders * 2)
    return Commands(VALVES, out)


def _meant(key: str, context: Context) -> tuple[str, str]:
    for ending, kind, names in ((_COMMAND, VALVES, context.cylinders), (_TORQUE, TORQUES, context.joints)):
        name = key.removesuffix(ending)
        if key.endswith(ending) and name in names:
            return kind, name
    for ending in (_FIRST, _SECOND):
        name = key.removesuffix(ending)
        if key.endswith(ending) and name in context.cylinders and context.rig.cylinders[name].valve.independent:
            return VALVES, key
    if key in context.cylinders:
        return VALVES, key
    if key in context.joints:
        return TORQUES, key
    commands = [f"{name}.{each}" for name in context.cylinders for each in context.rig.cylinders[name].commands]
    known = [*commands, *(f"{name}{_TORQUE}" for name in context.joints), *context.cylinders]
    raise ScenarioError(f'"{key}" is no command{nearest(key, known)}')


def _said(kind: str) -> str:
    return "valve command" if kind == VALVES else "torque"


def _check_finite(values: NDArray[np.float64], names: Sequence[str]) -> None:
    for name, value in zip(names, values):
        if not math.isfinite(value):
            raise ScenarioError(f'"{name}" is {value}, not a number that can be commanded')
