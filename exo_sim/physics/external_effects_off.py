"""Effects from outside the package are called once in plain Python, where they are off, before machine code is made of them.

A slip in such a function is then one line that names its file, and that "off" stays the paper is not left to trust.
"""

from __future__ import annotations

import math
import traceback
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from exo_sim.errors import ModelError, one_line
from exo_sim.physics.conditions import Chamber, Motion
from exo_sim.physics.declaration import Effect
from exo_sim.physics.external_effects import Source, sources
from exo_sim.physics.plant_records import WORLD
from exo_sim.physics.terms import TERMS

#: A chamber of a bench at 5 bar, half way out and in motion, its neighbour, and such a part in motion.
_HERE = Chamber(1, 5e5, 300.0, 7e-5, 293.0, 8e-4, 0.08, 0.1, 0.08, 0.1, 8e-4, 0.16)
_THERE = _HERE._replace(side=2, p=3e5, area=7e-4, speed=-0.1)
_MOTION = Motion(0.08, 0.1, 1e-5, 4e5, 2e5)
_WORLD = {
    "k": 1.4, "r": 287.05, "atmosphere": 101325.0, "ambient": 293.15, "supply_pressure": 7e5, "supply_temperature": 293.15,
    "exhaust_pressure": 101325.0,
}  # fmt: skip
#: By the name of a term, what its functions are given after the effect's own record; `None` is the world.
_ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "flow to the surroundings": (_HERE, _THERE, None), "flow between the chambers": (_HERE, _THERE, None),
    "heat into the gas": (_HERE, None), "dry friction": (_MOTION,), "on top of dry friction": (np.float64(3.0), _MOTION),
    "damping": (_MOTION,), "spring force": (_MOTION,),
}  # fmt: skip


def check_external_effects() -> None:
    """Call every function of an effect from outside with that effect off.

    Raises:
        ModelError: it fails, or returns something else than zero; the message names the file and, of a failure, the line.
    """
    for source in sources():
        effect: Effect = source.effect()
        for term in TERMS:
            if (function := term.function(effect.name)) is not None:
                _call(source, effect, function, _ARGUMENTS[term.name])


def _call(source: Source, effect: Effect, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    plain = getattr(function, "py_func", function)
    world = Record(_zeros(WORLD) | {name: np.float64(value) for name, value in _WORLD.items()})
    own = Record({parameter.name: np.float64(0.0) for parameter in effect.parameters})
    try:
        with np.errstate(all="ignore"):
            value = plain(own, *(world if one is None else one for one in arguments))
            size = float(value)
    except Exception as error:
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(source.path)]
        at = f", line {lines[-1]}" if lines else ""
        said = one_line(f"{type(error).__name__}: {error}")
        raise ModelError(f"{source.label}{at}: {said}, in {plain.__name__} of {effect.name}") from error
    if size != 0.0:
        what = "no number" if math.isnan(size) else f"{size:g}"
        where = f"{source.label}: {plain.__name__} of {effect.name}"
        raise ModelError(f"{where} returns {what} where all its parameters are zero: it must return 0")


class Record:
    """Fields as attributes and by name, as machine code has them; NumPy's own records have attributes besides, `size` among them."""

    def __init__(self, fields: Mapping[str, Any]) -> None:
        self.__dict__.update(fields)

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


def _zeros(kind: np.dtype[Any]) -> dict[str, Any]:
    fields: Mapping[str, tuple[Any, ...]] = kind.fields or {}
    return {name: Record(_zeros(one[0])) if one[0].fields else np.float64(0.0) for name, one in fields.items()}
