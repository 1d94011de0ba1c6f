"""What becomes of the numbers that decide while a diagnosis runs: which comparisons each enters, and how these come out."""

from __future__ import annotations

import importlib
import operator
import pkgutil
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from exo_sim.conventions import limits
from exo_sim.deciding_number import Count, Number
from exo_sim.diagnosis import policy

#: By number and place in the source, how often a comparison came out false and true.
Outcomes = dict[str, dict[str, list[int]]]

_HERE = __file__
_PACKAGE = Path(policy.__file__).parents[2]
_COMPARED = ("lt", "le", "gt", "ge")
_COMPUTED = ("add", "sub", "mul", "truediv", "pow", "floordiv", "mod")


class Traced(float):
    """A number that was computed from numbers that decide.

    Attributes:
        origins: Their names.
    """

    origins: frozenset[str]
    __array_priority__ = 1000.0  # an array or a scalar of numpy leaves the operation to it


class NumberLog:
    """Logs what every number of `policy` enters, from now on, in this process.

    Arithmetic of single numbers is followed; where a number goes into an array or a function of C it counts as used.

    Attributes:
        compared: Outcomes of comparisons.
        used: Places in the source where a number was computed with, by number.
    """

    def __init__(self) -> None:
        self.compared: Outcomes = defaultdict(lambda: defaultdict(lambda: [0, 0]))
        self.used: dict[str, set[str]] = defaultdict(set)
        self._names = {id(value): name for name, value in numbers()}
        for kind in (Number, Count, Traced):
            plain = int if issubclass(kind, int) else float
            setattr(kind, "__array_priority__", Traced.__array_priority__)  # noqa: B010
            for name in _COMPARED:
                setattr(kind, f"__{name}__", self._comparison(getattr(operator, name), plain))
            for name in _COMPUTED:
                function = getattr(operator, name)
                setattr(kind, f"__{name}__", self._arithmetic(function, plain))
                setattr(kind, f"__r{name}__", self._arithmetic(_reflected(function), plain))
            setattr(kind, "__neg__", self._arithmetic(lambda own, other: -own, plain, alone=True))  # noqa: B010

    def _origins(self, value: Any) -> frozenset[str]:
        if isinstance(value, Traced):
            return value.origins
        return frozenset({self._names.get(id(value), "?")}) if isinstance(value, (Number, Count)) else frozenset()

    def _comparison(self, function: Callable[[Any, Any], Any], plain: type) -> Callable[[Any, Any], Any]:
        def compare(own: Any, other: Any) -> Any:
            found = function(plain(own), _bare(other))
            if found is NotImplemented:
                return found
            place = _place()
            for name in self._origins(own) | self._origins(other):
                counts = self.compared[name][place]
                counts[0] += int(not np.all(found))
                counts[1] += int(np.any(found))
            return found

        return compare

    def _arithmetic(self, function: Callable[[Any, Any], Any], plain: type, alone: bool = False) -> Callable[..., Any]:
        def compute(own: Any, other: Any = 0, *more: Any) -> Any:
            found = function(plain(own), _bare(other))
            if found is NotImplemented:
                return found
            origins = self._origins(own) | (frozenset() if alone else self._origins(other))
            place = _place()
            for name in origins:
                self.used[name].add(place)
            if isinstance(found, float) and not isinstance(found, Traced):
                found = Traced(found)
                found.origins = origins
            return found

        return compute


def numbers() -> Iterator[tuple[str, Number | Count]]:
    """Yield every number of `policy` and of the conventions with its name, "file.NAME", or "file.NAME[key]" in a table."""
    modules = [importlib.import_module(f"{policy.__name__}.{module.name}") for module in pkgutil.iter_modules(policy.__path__)]
    for module in (*modules, limits):
        for name, value in vars(module).items():
            every = value.items() if isinstance(value, dict) else [("", value)]
            for key, one in every:
                if name.isupper() and isinstance(one, (Number, Count)):
                    yield f"{module.__name__.rpartition('.')[2]}.{name}" + (f"[{key}]" if key else ""), one


def _reflected(function: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    return lambda own, other: function(other, own)


def _bare(value: Any) -> Any:
    """Return a number without the log, anything else as it is."""
    if isinstance(value, Count):
        return int(value)
    return float(value) if isinstance(value, (Number, Traced)) else value


def _place() -> str:
    """Return file and line of the package that the number was used in."""
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename == _HERE:
        frame = frame.f_back
    path = Path(frame.f_code.co_filename)
    return f"{path.relative_to(_PACKAGE)}:{frame.f_lineno}" if path.is_relative_to(_PACKAGE) else f"{path.name}:{frame.f_lineno}"
