"""What a file in `effects/` says of the effect that it holds. Simulator, rig file, diagnosis, docs and tests all read this."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache

from exo_sim.errors import ModelError, nearest
from exo_sim.physics import external_effects
from exo_sim.physics.identification import Identification

__all__ = ["BESIDE_THE_GAS", "FAMILIES", "PLACES", "Effect", "Identification", "Parameter", "declared", "identification_of"]

#: Where an effect may act. "cylinder" and "joint" are named parts; "supply" and "exhaust" are shared; "column" is a sensor.
PLACES = ("cylinder", "joint", "supply", "exhaust", "column")

#: What kind of law an effect is part of.
FAMILIES = (
    "friction", "spring", "transmission", "valve", "flow law", "line", "cushion", "leak", "wall", "supply", "exhaust", "sensor", "unknown"
)  # fmt: skip

#: Which part of the plant a diagnosis cuts out to ask for an effect; "any" where a parameter decides.
CUTS = ("gas", "motion", "sensor", "any")

#: SI units of effects on motion, at a sliding part: a balance of forces knows how large these may be.
OF_FORCES = ("N", "N s/m", "N s^2/m^2", "N/m", "m", "m/s", "m^2", "1")

#: Nominal numbers that an effect may be mistaken for.
CALIBRATED = ("dead_volume", "flow_capacity", "payload_mass")

#: Families that hand something to the gas (where the piston is, how far each path is open) but have no term in its balances.
BESIDE_THE_GAS = ("friction", "spring", "transmission", "valve")


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Attributes:
        name: Its key in a rig file.
        unit: SI unit on a cylinder or a shared part.
        low, high: Bounds of what is plausible; outside them a rig file is refused.
        typical: The range met in practice.
        source: Where the range comes from.
        angular_unit: SI unit where the effect acts on a turning joint, if it differs.
        required: False where the effect works without it.
        choices: Words that stand for 0, 1, 2 ... where the parameter is a choice.
        shapes: The parameter without which a choice means nothing, "" where it always means something.
        by_reversals: True where a choice shows only where commands switch the valve straight from one side to the other.
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
    shapes: str = ""
    by_reversals: bool = False
    default: float = 0.0
    most: int = 0
    unit_by: tuple[str, tuple[tuple[str, str], ...]] | None = None

    def unit_at(self, turning: bool, choice: int = 0) -> str:
        """Return the SI unit on a sliding part, or on a turning one; `choice` is the value of the parameter that decides."""
        if self.unit_by is not None:
            return self.unit_by[1][choice][turning]
        return self.angular_unit if turning and self.angular_unit else self.unit


@dataclass(frozen=True)
class Effect:
    """One piece of physics that the paper leaves out.

    Attributes:
        name: As in `[effects.NAME.WHERE]`.
        places: Where it may act.
        family: Which law it is part of, one of `FAMILIES`.
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
        valid: Where its law holds, and what it leaves out.
        signature: What it looks like in a recording.
        convention: What its numbers mean exactly, where they could be read in two ways.
        identification: How a diagnosis puts the question.

    Raises:
        ModelError: an unknown family or place, or a question about a parameter that it does not have.
    """

    name: str
    places: tuple[str, ...]
    family: str
    question: str
    says: str
    parameters: tuple[Parameter, ...]
    cut: str
    reveals: tuple[str, ...]
    mistaken_for: tuple[str, ...]
    experiment: str
    valid: str
    signature: str
    needs: tuple[str, ...] = ()
    any_of: tuple[tuple[str, ...], ...] = ()
    requires: str = ""
    convention: str = ""
    absorbs: tuple[tuple[str, tuple[tuple[str, str], ...]], ...] = ()
    needs_valve: bool = False
    check: Callable[[str, Mapping[str, float], Mapping[str, tuple[float, ...]]], str] | None = None
    identification: Identification = field(default_factory=Identification)

    def __post_init__(self) -> None:
        if self.family not in FAMILIES:
            raise ModelError(f"effect {self.name}: {self.family!r} is no family of effects{nearest(self.family, FAMILIES)}")
        for place in self.places:
            if place not in PLACES:
                raise ModelError(f"effect {self.name}: {place!r} is no place where effects act{nearest(place, PLACES)}")
        if self.cut not in CUTS:
            raise ModelError(f"effect {self.name}: {self.cut!r} is no part of the plant that a diagnosis cuts out{nearest(self.cut, CUTS)}")
        for parameter in self.parameters:
            if self.cut == "motion" and parameter.unit not in OF_FORCES:
                raise ModelError(
                    f"effect {self.name}: no balance of forces knows how large {parameter.name} in {parameter.unit!r} may be: "
                    f"give it in one of {', '.join(OF_FORCES)}"
                )
        known = [parameter.name for parameter in self.parameters]
        for key, names in self.identification.parameters.items():
            for name in sorted(names - set(known)):
                raise ModelError(f"effect {self.name}: identification.{key}: {name!r} is none of its parameters{nearest(name, known)}")

    def parameter(self, name: str) -> Parameter:
        """Return the parameter called `name`; KeyError where there is none."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


@cache
def declared() -> dict[str, Effect]:
    """Return every effect declared in this folder, by installed packages and in files that the environment names, by name.

    Raises:
        ModelError: one outside cannot be used, or has the name of one that there is already.
    """
    package = importlib.import_module("exo_sim.physics.effects")
    names = sorted(info.name for info in pkgutil.iter_modules(package.__path__))
    found: dict[str, Effect] = {}
    for name in names:
        effect: Effect = importlib.import_module(f"{package.__name__}.{name}").EFFECT
        found[effect.name] = effect
    for source in external_effects.sources():
        effect = source.effect()
        if not isinstance(effect, Effect):
            raise ModelError(f"{source.label}: {source.attribute} is a {type(effect).__name__}, no Effect of exo_sim.physics.declaration")
        if effect.name in found:
            raise ModelError(f"{source.label}: there is an effect {effect.name} already: give yours another name")
        found[effect.name] = effect
    for effect in found.values():
        check_others(effect, found)
    return dict(sorted(found.items()))


def check_others(effect: Effect, found: Mapping[str, Effect]) -> None:
    """Raise ModelError where an effect names another that there is not."""
    asked = effect.identification
    same = asked.twins
    twins = (*same.unmeasured, *same.measured, *same.unseen, *same.in_one_chamber, *same.as_parts, same.beside_constant)
    effects = (effect.requires, *(name for name, _ in effect.absorbs), asked.on_top_of, asked.closed_beside, *twins)
    for name, known in (*((name, found) for name in effects if name), *((name, {*found, *CALIBRATED}) for name in effect.mistaken_for)):
        if name not in known:
            raise ModelError(f"effect {effect.name}: there is no effect {name!r}{nearest(name, known)}")
    for name, parts in asked.twins.as_parts.items():
        own = {parameter.name for parameter in found[name].parameters}
        if unknown := sorted(set(parts) - own):
            raise ModelError(f"effect {effect.name}: {name} has no parameter {unknown[0]!r}{nearest(unknown[0], own)}")


def identification_of(name: str) -> Identification:
    """Return how the question of an effect is put; of a name that no effect has, nothing but defaults."""
    effect = declared().get(name)
    return Identification() if effect is None else effect.identification


def family_of(name: str) -> str:
    """Return the family of an effect; of a name that no effect has, such as a nominal number's, ""."""
    effect = declared().get(name)
    return "" if effect is None else effect.family
