"""What a file in this folder says of the effect that it holds. Simulator, rig file, diagnosis, docs and tests all read this."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
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
        most: The longest list where the parameter is a list of numbers; 0 where it is one number.
        unit_by: For a list whose unit follows from choices: the deciding parameter and the SI units in the order of its words.
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
    most: int = 0
    unit_by: tuple[str, tuple[tuple[str, str], ...]] | None = None

    def unit_at(self, turning: bool, choice: int = 0) -> str:
        """Return the SI unit on a sliding part, or on a turning one; `choice` is the value of the parameter that decides."""
        if self.unit_by is not None:
            return self.unit_by[1][choice][turning]
        return self.angular_unit if turning and self.angular_unit else self.unit


@dataclass(frozen=True)
class Asked:
    """How the question is put to a recording.

    Attributes:
        forms: Which parameters are free together; one form with all of them where empty.
        starts: Values to begin with where the range is wide or the answer not in proportion; else a low and a high typical one.
        starts_by_valve: As `starts`, areas in units of the valve's.
        starts_by_reach: As `starts_by_valve`, lengths in units of half the stroke and counted from where the piston comes nearest to
            an end.
        proportional: Whether it is linear in its parameters from zero on: a signature may then be scaled until it shows.
        jerky: Whether its answer is in jerks: play, dead zones, limits.
        healthy: What a healthy machine shows of a parameter as well: one standard deviation, and the most. A fit may move it up
            to there; only what is larger is a finding.
        least: Parameters of which less than this is no finding.
        adds_up: Whether its parameters are parts of one thing: then their sum is held against `least`.
        leaks: For a leak, its share of what empties a healthy cylinder in some minutes; 0 where it is none.
        on_top_of: Effect that must be there for it to be asked.
        open_by: Factors on the ends of a parameter's interval, for what the model itself leaves open ...
        closed_by: ... unless this parameter was fitted as well.
    """

    forms: tuple[tuple[str, ...], ...] = ()
    starts: tuple[tuple[float, ...], ...] = ()
    starts_by_valve: tuple[tuple[float, ...], ...] = ()
    starts_by_reach: tuple[tuple[float, ...], ...] = ()
    proportional: bool = False
    jerky: bool = False
    healthy: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)
    adds_up: bool = False
    leaks: float = 0.0
    on_top_of: str = ""
    open_by: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    closed_by: str = ""

    def smallest(self, parameter: str) -> float:
        """Return what less of a parameter is no finding."""
        return self.least.get(parameter, self.healthy.get(parameter, (0.0, 0.0))[1])


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
        cut: Which part of the plant feels it: "gas", "motion", "sensor", or "any" where a parameter decides.
        mistaken_for: Names of effects with a like signature.
        experiment: What to do to tell them apart.
        requires: An effect that must be on at the same part.
        absorbs: Effects of which this one is the richer form, so that both cannot be on at the same part: for each, which
            parameters of this one contain which of the other's.
        check: Of a place's kind and the numbers, each within bounds, says in words what is wrong with them together, or "".
        needs_valve: True where it acts in a valve, so that a cylinder without one cannot have it.
        signature: What it looks like in a recording.
        convention: What its numbers mean exactly, where they could be read in two ways.
        asked: How a diagnosis puts the question.
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
    convention: str = ""
    absorbs: tuple[tuple[str, tuple[tuple[str, str], ...]], ...] = ()
    needs_valve: bool = False
    check: Callable[[str, Mapping[str, float], Mapping[str, tuple[float, ...]]], str] | None = None
    asked: Asked = Asked()

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
