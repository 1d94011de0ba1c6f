"""Numbers that a fit may move: believed ones that a data sheet leaves open, and the parameters of candidate effects."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.effects.declaration import Effect

#: How far a believed number may be off, one standard deviation: what a data sheet allows, and what tuning has done to it.
SPREADS = {"flow_capacity": 0.10, "dead_volume_1": 0.15, "dead_volume_2": 0.15, "payload_mass": 0.05}


@dataclass
class Setting:
    """One cylinder with its surroundings as a fit believes it: records of shape (1,), and what is said of its sensors.

    `sensors` maps e.g. `"position.delay"`, `"pressure_1.bias"`, `"pressure_2.scale"` to a number; absent means a perfect sensor.
    """

    world: NDArray[np.void]
    cylinder: NDArray[np.void]
    sensors: dict[str, float] = field(default_factory=dict)

    def is_on(self, effect: Effect) -> bool:
        """Say whether an effect has any number in the records already."""
        record = self.world if effect.name in (self.world.dtype.names or ()) else self.cylinder
        return any(float(record[effect.name][parameter.name][0]) != 0.0 for parameter in effect.parameters)

    def copy(self) -> Setting:
        """Return a copy that shares nothing."""
        return Setting(self.world.copy(), self.cylinder.copy(), dict(self.sensors))


@dataclass(frozen=True)
class Quantity:
    """One number that a fit may move.

    Attributes:
        effect: Name of the effect or of the calibration.
        where: The part.
        parameter: Name of the parameter.
        unit: SI unit.
        target: "world", "cylinder", "factor" (on a field of the cylinder) or "sensor".
        scale: A typical size: steps and starts are in units of it.
        low, high: Bounds.
        prior: Mean and standard deviation, or None.
        neutral: Its value where the effect is off.
        wide: True where the typical range spans decades: then a fit moves its logarithm.
        least: Further from neutral than this, or it is nothing that a healthy machine would not show.
        rough: True where predictions answer it in jerks (play, dead zones): finite differences must be wide.
    """

    effect: str
    where: str
    parameter: str
    unit: str
    target: str
    scale: float
    low: float
    high: float
    prior: tuple[float, float] | None = None
    neutral: float = 0.0
    rough: bool = False
    least: float = 0.0
    wide: bool = False

    @property
    def key(self) -> tuple[str, str, str]:
        """What tells it from all others."""
        return self.effect, self.where, self.parameter

    def coordinate(self, value: float) -> float:
        """Return a value as a fit counts it: in units of the scale, or its logarithm."""
        return math.log(max(value, 1e-12 * self.scale) / self.scale) if self.wide else value / self.scale

    def value(self, coordinate: float) -> float:
        """Return the value at a coordinate, inside the bounds."""
        value = math.exp(min(coordinate, 60.0)) * self.scale if self.wide else coordinate * self.scale
        return min(max(value, self.low), self.high)

    def slope(self, value: float) -> float:
        """Return how the value answers its coordinate there."""
        return value if self.wide else self.scale

    @property
    def field(self) -> tuple[str, str]:
        """Which number of a setting it is: two quantities of one field stand for the same thing."""
        return ("" if self.target == "sensor" else self.effect), self.parameter

    def put(self, setting: Setting, value: float) -> None:
        """Write the number into a setting."""
        if self.target == "world":
            setting.world[self.effect][self.parameter] = value
        elif self.target == "cylinder":
            setting.cylinder[self.effect][self.parameter] = value
        elif self.target == "factor":
            setting.cylinder[self.parameter] *= value
        else:
            setting.sensors[self.parameter] = value


Values = Mapping[Quantity, float]


@dataclass(frozen=True)
class Candidate:
    """One effect in one of its forms, as a question to the data.

    Attributes:
        effect: Its name.
        where: The part.
        form: Which of its forms: the parameters that are free, joined by "+".
        quantities: What is fitted.
        starts: Sets of values to try first, in the order of `quantities`.
        kind: "missing_physics", "calibration" or "sensor".
        fixed: Parameters that this form pins to a value.
        proportional: Whether its signature may be scaled up or down until it shows.
        beside: Effect that must be in the set as well, or "": what comes on top of another.
        adds_up: Whether its numbers are parts of one thing.
    """

    effect: str
    where: str
    form: str
    quantities: tuple[Quantity, ...]
    starts: tuple[tuple[float, ...], ...]
    kind: str = "missing_physics"
    fixed: tuple[tuple[Quantity, float], ...] = ()
    proportional: bool = True
    beside: str = ""
    adds_up: bool = False

    @property
    def key(self) -> tuple[str, str, str]:
        """What tells it from all others."""
        return self.effect, self.where, self.form

    @property
    def label(self) -> str:
        """Effect, place and form in one word."""
        return f"{self.effect}@{self.where}[{self.form}]"


def standing(chosen: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return those candidates of a set whose own ground is in it: what comes on top of another goes with it."""
    effects = {candidate.effect for candidate in chosen}
    kept = tuple(candidate for candidate in chosen if not candidate.beside or candidate.beside in effects)
    return kept if len(kept) == len(chosen) else standing(kept)
