"""Numbers that a fit may move: believed ones that a data sheet leaves open, and the parameters of candidate effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

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

    @property
    def key(self) -> tuple[str, str, str]:
        """What tells it from all others."""
        return self.effect, self.where, self.parameter

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
    """

    effect: str
    where: str
    form: str
    quantities: tuple[Quantity, ...]
    starts: tuple[tuple[float, ...], ...]
    kind: str = "missing_physics"
    fixed: tuple[tuple[Quantity, float], ...] = ()
    proportional: bool = True

    @property
    def key(self) -> tuple[str, str, str]:
        """What tells it from all others."""
        return self.effect, self.where, self.form

    @property
    def label(self) -> str:
        """Effect, place and form in one word."""
        return f"{self.effect}@{self.where}[{self.form}]"
