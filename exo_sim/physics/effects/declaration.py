"""What a file in this folder says of the effect that it holds. Simulator, rig file, diagnosis, docs and tests all read this."""

from __future__ import annotations

import importlib
import pkgutil
from dataclasses import dataclass
from functools import cache

#: Where an effect may act. "cylinder" and "joint" are named parts; "supply" and "exhaust" are shared; "column" is a sensor.
PLACES = ("cylinder", "joint", "supply", "exhaust", "column")


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Attributes:
        name: Its key in a rig file.
        unit: SI unit on a cylinder or a shared part.
        low, high: Bounds of what can be believed; outside them a rig file is refused.
        typical: The range met in practice.
        source: Where the range comes from.
        angular_unit: SI unit where the effect acts on a turning joint, if it differs.
        required: False where the effect works without it.
        choices: Words that stand for 0, 1, 2 ... where the parameter is a choice.
        default: Value of a parameter that is not required.
    """

    name: str
    unit: str
    low: float
    high: float
    typical: tuple[float, float]
    source: str
    angular_unit: str | None = None
    required: bool = True
    choices: tuple[str, ...] = ()
    default: float = 0.0

    def unit_at(self, turning: bool) -> str:
        """Return the SI unit on a sliding part, or on a turning one."""
        return self.angular_unit if turning and self.angular_unit else self.unit


@dataclass(frozen=True)
class Effect:
    """One piece of physics that the paper leaves out.

    Attributes:
        name: As in `[effects.NAME.WHERE]`.
        places: Where it may act.
        question: The plain question that it answers.
        says: One plain sentence for a report, true where the effect was found.
        parameters: All of them.
        any_of: Sets of parameters, one of which must be given; empty where `required` says it all.
        reveals: Signals (names behind the dot) one of which must be recorded for it to show.
        needs: Signals all of which must be recorded.
        cut: Which part of the plant feels it: "gas", "motion", "supply" or "sensor".
        mistaken_for: Names of effects with a like signature.
        experiment: What to do to tell them apart.
        requires: An effect that must be on at the same part.
        excludes: Effects that cannot be on at the same part.
        signature: What it looks like in a recording.
    """

    name: str
    places: tuple[str, ...]
    question: str
    says: str
    parameters: tuple[Parameter, ...]
    cut: str
    reveals: tuple[str, ...]
    mistaken_for: tuple[str, ...]
    experiment: str
    signature: str
    needs: tuple[str, ...] = ()
    any_of: tuple[tuple[str, ...], ...] = ()
    requires: str = ""
    excludes: tuple[str, ...] = ()

    def parameter(self, name: str) -> Parameter:
        """Return the parameter called `name`; KeyError where there is none."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


@cache
def declared() -> dict[str, Effect]:
    """Return every effect declared in this folder, by name, in alphabetical order."""
    package = importlib.import_module("exo_sim.physics.effects")
    found = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(package.__path__)):
        if module != "declaration":
            effect: Effect = importlib.import_module(f"{package.__name__}.{module}").EFFECT
            found[effect.name] = effect
    return found
