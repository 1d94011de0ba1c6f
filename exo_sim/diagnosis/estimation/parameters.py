"""The parameters of a plant, and those of them that a fit may move: nuisance parameters and the parameters of candidate effects."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.nominal_numbers import CARD_OF_PRESSURES, POSITION_DELAY
from exo_sim.physics.declaration import Effect, declared


class Target(StrEnum):
    """Where the number of a free parameter is written: a shared record, a cylinder's, as a factor on the latter, or a sensor."""

    WORLD = "world"
    CYLINDER = "cylinder"
    FACTOR = "factor"
    SENSOR = "sensor"


@dataclass(frozen=True)
class PlantParameters:
    """All numbers of one subsystem: its cylinder, the surroundings, and the errors of its sensors.

    Attributes:
        world, cylinder: Records of `physics.records`, shape (1,) each.
        sensors: E.g. `"position.delay"`, `"pressure_1.bias"`, `"pressure_2.scale"` to a number; absent means a perfect sensor.
            `"pressures.delay"` comes on top of that of each pressure: they share a card; `"supply.scale"` is by how much the pressure of
            a supply that was not recorded differs from the nominal one. A `"position.delay"` below zero is one of the pressures' card:
            `card_delays`. How warm the gas is where a recording begins is beside them (`subsystems/gas/initial_temperature.py`).
    """

    world: NDArray[np.void]
    cylinder: NDArray[np.void]
    sensors: dict[str, float] = field(default_factory=dict)

    def is_on(self, effect: Effect) -> bool:
        """Return whether any parameter of an effect differs from zero; of one that it has no numbers of, none does."""
        return bool(self.numbers_of(effect))

    def numbers_of(self, effect: Effect) -> dict[str, float]:
        """Return the parameters of an effect that differ from zero, by name."""
        records = [record for record in (self.world, self.cylinder) if effect.name in (record.dtype.names or ())]
        numbers = {p.name: float(record[effect.name][p.name][0]) for record in records for p in effect.parameters}
        return {name: value for name, value in numbers.items() if value != 0.0}

    @property
    def contained_effects(self) -> set[str]:
        """Effects of which it has a richer form on, that says all that they say."""
        richer = [effect for effect in declared().values() if effect.absorbs and self.is_on(effect)]
        return {name for effect in richer for name, _ in effect.absorbs}

    def copy(self) -> PlantParameters:
        """Return a copy that shares no array."""
        return PlantParameters(self.world.copy(), self.cylinder.copy(), dict(self.sensors))

    def with_values(self, values: Iterable[tuple[FreeParameter, float]]) -> PlantParameters:
        """Return a copy in which these parameters have these values, written in their order."""
        changed = self.copy()
        for parameter, value in values:
            _WRITE[parameter.target](changed, parameter, value)
        return changed


@dataclass(frozen=True)
class FreeParameter:
    """One number that a fit may move.

    Attributes:
        effect: Name of the effect or of the calibration.
        where: The part.
        parameter: Name of the parameter.
        unit: SI unit.
        target: Where its value is written.
        scale: Typical size: finite differences and starts are in units of it.
        low, high: Bounds.
        prior: Mean and standard deviation of a normal prior, or None.
        neutral: Value at which the effect is off.
        nonsmooth: Whether predictions respond to it in jumps (play, dead zones): finite differences must be wide.
        healthy_limit: Distance from neutral up to which a healthy machine shows it as well; only a larger one is a finding.
        logarithmic: Whether its typical range spans decades: a fit then moves its logarithm.
        displaces: Nuisance parameters in which an owner may have counted it, each with its share of their unit: a hose's volume in the
            dead volume.
        saturates: Whether it throttles: what it does goes with the inverse of its square, and from its upper bound on it does nothing.
    """

    effect: str
    where: str
    parameter: str
    unit: str
    target: Target
    scale: float
    low: float
    high: float
    prior: tuple[float, float] | None = None
    neutral: float = 0.0
    nonsmooth: bool = False
    healthy_limit: float = 0.0
    logarithmic: bool = False
    displaces: tuple[tuple[tuple[str, str, str], float], ...] = ()
    saturates: bool = False

    @property
    def key(self) -> tuple[str, str, str]:
        """What identifies it."""
        return self.effect, self.where, self.parameter

    @property
    def slot(self) -> tuple[str, str]:
        """Which number of the plant it is: two free parameters of one slot stand for the same number."""
        return ("" if self.target is Target.SENSOR else self.effect), self.parameter

    @property
    def is_shape(self) -> bool:
        """Whether it only shapes a law, such as the power of speed that a film resists with: of no unit, and roughly known."""
        return self.unit == "1" and self.prior is not None and self.target is Target.CYLINDER

    @property
    def start(self) -> float:
        """Where a fit begins without a better guess: the prior's mean, or neutral."""
        return self.prior[0] if self.prior else self.neutral

    def coordinate(self, value: float) -> float:
        """Return the coordinate of a value in a fit: in units of the scale, or its logarithm."""
        return math.log(max(value, 1e-12 * self.scale) / self.scale) if self.logarithmic else value / self.scale

    def value(self, coordinate: float) -> float:
        """Return the value at a coordinate, inside the bounds."""
        value = math.exp(min(coordinate, 60.0)) * self.scale if self.logarithmic else coordinate * self.scale
        return min(max(value, self.low), self.high)

    def slope(self, value: float) -> float:
        """Return the derivative of the value with respect to its coordinate."""
        return value if self.logarithmic else self.scale


def card_delays(sensors: Mapping[str, float]) -> tuple[float, float]:
    """Return how late the position and the card of the pressures come [s].

    No sensor shows what is yet to come: a position that seems early has pressures beside it that are late, behind their filter.
    """
    position = sensors.get(POSITION_DELAY, 0.0)
    return max(position, 0.0), sensors.get(CARD_OF_PRESSURES, 0.0) + max(-position, 0.0)


#: Values of free parameters.
Values = Mapping[FreeParameter, float]


def _write_world(plant: PlantParameters, parameter: FreeParameter, value: float) -> None:
    plant.world[parameter.effect][parameter.parameter] = value


def _write_cylinder(plant: PlantParameters, parameter: FreeParameter, value: float) -> None:
    plant.cylinder[parameter.effect][parameter.parameter] = value


def _write_factor(plant: PlantParameters, parameter: FreeParameter, value: float) -> None:
    plant.cylinder[parameter.parameter] *= value


def _write_sensor(plant: PlantParameters, parameter: FreeParameter, value: float) -> None:
    plant.sensors[parameter.parameter] = value


_WRITE: Mapping[Target, Callable[[PlantParameters, FreeParameter, float], None]] = {
    Target.WORLD: _write_world,
    Target.CYLINDER: _write_cylinder,
    Target.FACTOR: _write_factor,
    Target.SENSOR: _write_sensor,
}
