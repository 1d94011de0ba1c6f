"""Somebody's own controller: any object with `reset(context)` and `act(observation)`, how one is loaded, and what it may return.

    class Impedance:
        period = 0.002                                   # optional: seconds between two calls of act; 0.002 where it is not given
        def reset(self, context): ...                    # before the first step; what it is given is a `Context`
        def act(self, observation): return {...}         # name of a signal to its value, "time" in seconds; commands until the next call

Commands are a dictionary, or numbers in the order of `context.cylinders`: `"knee_l"` or `"knee_l.valve_command"` opens that cylinder's
valve, -1 to 1 (where its edges are independent `"knee_l.valve_command_1"` and `_2` open those of each chamber); `"knee_l.torque"` asks
for a joint's torque [N m] (of a sliding joint, its force [N]), which the built-in force loop
then makes. One kind at a time; what is left out is 0.
"""

from __future__ import annotations

import importlib.util
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.control import own_faults
from exo_sim.errors import ScenarioError, nearest
from exo_sim.inputs import check_regular
from exo_sim.rig import Rig

#: Seconds between two calls of `act` where the controller does not tell.
PERIOD = 0.002
VALVES, TORQUES = "valves", "torques"
_COMMAND, _TORQUE = ".valve_command", ".torque"
#: Of a valve with independent edges: the command towards each chamber.
_FIRST, _SECOND = ".valve_command_1", ".valve_command_2"


@dataclass(frozen=True)
class Context:
    """What a controller gets before the first step.

    Attributes:
        rig: The machine.
        cylinders: Their names, in the order of commands without names.
        joints: Joints whose torque can be asked for.
        signals: What the observation holds, beside "time".
        period: Seconds between two calls of `act`.
        step: Of the simulation [s].
        duration: Of the run [s].
        cycle: Of the scenario's motion [s]; None where there is none.
        scenario: Its name.
        payload: On the back [kg].
        seed: Where chance starts.
        reference: What each joint is to do at a time [s]: `reference(time)` gives joint to position and velocity.
    """

    rig: Rig
    cylinders: tuple[str, ...]
    joints: tuple[str, ...]
    signals: tuple[str, ...]
    period: float
    step: float
    duration: float
    cycle: float | None = None
    scenario: str = ""
    payload: float = 0.0
    seed: int = 0
    reference: Any = field(default=None, compare=False)


class Controller(Protocol):
    """What people bring."""

    def reset(self, context: Context) -> None:
        """Begin anew."""

    def act(self, observation: Mapping[str, float]) -> Any:
        """Return commands."""


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


def is_path(text: str) -> bool:
    """Return whether a controller's name tells a file of somebody's own."""
    return text.partition(":")[0].lower().endswith(".py") or ".py:" in text


def load(text: str) -> Controller:
    """Return the controller that `"FILE.py:NAME"` names; the name may be left out where the file has one controller.

    Raises:
        ScenarioError: no such file or class, or the file fails; the message names file and line.
    """
    file, _, name = text.rpartition(":") if ".py:" in text else (text, "", "")
    path = Path(file)
    try:
        check_regular(path)
    except FileNotFoundError:
        near = nearest(path.name, [p.name for p in path.parent.glob("*.py")]) if path.parent.is_dir() else ""
        raise ScenarioError(f'controller "{text}": there is no file "{path}"{near if "mean" in near else ""}') from None
    except (OSError, ValueError) as error:
        raise ScenarioError(f'controller "{text}": "{path}" {error}') from None
    spec = importlib.util.spec_from_file_location(f"controller_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses and pickling look for it there
    try:
        spec.loader.exec_module(module)
    except BaseException as error:
        if own_faults.is_interrupt(error):
            raise
        raise ScenarioError(f"controller {own_faults.place(error, path)}") from None
    made = {
        key: value
        for key, value in vars(module).items()
        if isinstance(value, type) and value.__module__ == spec.name and callable(own_faults.attribute(value, "act"))
    }
    if not name:
        if len(made) != 1:
            raise ScenarioError(f'controller "{text}": name one class of the file, like {path.name}:NAME{nearest("", made)}')
        name = next(iter(made))
    given = own_faults.attribute(module, name)
    if given is None:
        raise ScenarioError(f'controller "{text}": {path} has no "{name}"{nearest(name, made)}')
    return of(given, f"{path}:{name}", path)


def of(given: Any, source: str = "", path: Path | None = None) -> Controller:
    """Return a controller from an object or a class, checked to have `reset` and `act`.

    Raises:
        ScenarioError: a method is missing, or making the object fails.
    """
    source = source or str(own_faults.attribute(given, "__name__", type(given).__name__))
    if isinstance(given, type) or (callable(given) and own_faults.attribute(given, "act") is None):
        try:
            given = given()
        except BaseException as error:
            if own_faults.is_interrupt(error):
                raise
            raise ScenarioError(f"controller {own_faults.place(error, path)}, while making {source}()") from None
    for method in ("reset", "act"):
        if not callable(own_faults.attribute(given, method)):
            argument = "context" if method == "reset" else "observation"
            raise ScenarioError(f"controller {source}: it has no method {method}(self, {argument}); a controller has reset and act")
    return given  # type: ignore[no-any-return]


def period_of(controller: Any, step: float, source: str) -> int:
    """Return how many steps of the simulation lie between two calls of `act`.

    Raises:
        ScenarioError: its `period` is no time, or shorter than a step.
    """
    period = own_faults.attribute(controller, "period", PERIOD)
    number = isinstance(period, int | float | np.integer | np.floating) and not isinstance(period, bool)
    if not number or not step * 0.999 <= period <= 1.0:
        raise ScenarioError(
            f"controller {source}: period = {own_faults.shown(period)}: write seconds between two calls, {step:g} (one step) to 1"
        )
    return max(1, round(float(period) / step))


class Interrupted(KeyboardInterrupt):
    """Ctrl-C while `act` was at work; `rows` steps of those that were to be taken are done."""

    def __init__(self, rows: int) -> None:
        super().__init__()
        self.rows = rows


class RunningController:
    """A controller in use: its calls, what it returns, and what it does wrong in one line.

    Args:
        controller: What somebody brought.
        context: What it gets.
        source: What to call it in messages.
    """

    def __init__(self, controller: Controller, context: Context, source: str = "") -> None:
        self.controller, self.context = controller, context
        self.source = source or type(controller).__name__
        self.kind = ""
        self.clipped = 0

    def reset(self) -> None:
        """Let it begin anew.

        Raises:
            ScenarioError: it fails; the message names file and line.
        """
        self.kind, self.clipped = "", 0
        try:
            self.controller.reset(self.context)
        except BaseException as error:
            if own_faults.is_interrupt(error):
                raise
            raise ScenarioError(f"controller {own_faults.place(error)}, in reset of {self.source}") from None

    def act(self, observation: Mapping[str, float]) -> Commands:
        """Ask for commands.

        Raises:
            ScenarioError: it fails, or what it returns is none; the message names file and line, or command and time.
        """
        time = observation["time"]  # before somebody's code has the dictionary
        try:
            returned = self.controller.act(observation)
        except BaseException as error:
            if own_faults.is_interrupt(error):
                raise
            raise ScenarioError(f"controller {own_faults.place(error)}, in act of {self.source} at {time:.3f} s") from None
        try:
            commands = read(returned, self.context, self.kind)
        except ScenarioError as error:
            raise ScenarioError(f"controller {self.source}, at {time:.3f} s: {error}") from None
        except Exception as error:  # of the objects in it, when they are asked for a number or a name
            raise ScenarioError(
                f"controller {self.source}, at {time:.3f} s: what act returned cannot be read ({own_faults.described(error)}); "
                'return a dictionary of numbers like {"knee_l": 0.5}'
            ) from None
        self.kind = commands.kind
        if commands.kind == VALVES:
            self.clipped += int(np.abs(commands.values).max(initial=0.0) > 1.5)
        return commands

    @classmethod
    def is_asked(cls, frame: FrameType | None) -> bool:
        """Return whether a frame, as a signal's handler is given, belongs to somebody's code at work."""
        return own_faults.is_within(frame, cls.reset.__code__, cls.act.__code__)

    def remarks(self) -> tuple[str, ...]:
        """Return what is worth saying after a run."""
        if self.clipped < 10:
            return ()
        return (
            f"controller {self.source}: {self.clipped} commands to valves were beyond -1 to 1 and counted as that; if they were meant as "
            'torques, return them as "knee_l.torque"',
        )


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
