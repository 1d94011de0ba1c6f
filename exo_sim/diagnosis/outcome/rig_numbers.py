"""The numbers of an improved rig that its recordings leave open, and the same update with others in their place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from exo_sim.diagnosis.estimation.uncertainty import HALF_WIDTH
from exo_sim.diagnosis.outcome.rig_update import Part, RigUpdate
from exo_sim.physics.declaration import declared
from exo_sim.rig import Correction, EffectEntry

#: Where a number stands: ("effects", name, where, parameter), or the key of a correction.
Place = tuple[str, ...]


@dataclass(frozen=True)
class OpenNumber:
    """A number that was fitted, and how well it is known, in SI.

    Attributes:
        place: Where it stands.
        value: As it was fitted.
        low, high: What holds it with 95 %.
    """

    place: Place
    value: float
    low: float
    high: float

    @property
    def error(self) -> float:
        """Its standard error, by the end of the interval that no bound has cut off."""
        return max(self.high - self.value, self.value - self.low) / HALF_WIDTH

    @property
    def cut(self) -> str:
        """Which part of the plant feels it: "gas", "motion", or "any"."""
        part, name = self.place[:2]
        return declared()[name].cut if part == "effects" else "motion" if part in ("bodies", "joints") else "gas"

    def at(self, errors: float) -> float:
        """Return what it is so many standard errors further up, never outside its interval."""
        return min(max(self.value + errors * self.error, self.low), self.high)


def open_numbers(update: RigUpdate) -> tuple[OpenNumber, ...]:
    """Return the numbers of the machine with an interval, each place once; zeros, gains and delays of sensors move no piston."""
    found: dict[Place, OpenNumber] = {}
    for entry in update.entries:
        setting = entry.setting
        if declared()[setting.name].cut == "sensor":
            continue
        for parameter, (low, high) in entry.intervals.items():
            place = ("effects", setting.name, setting.where, parameter)
            found.setdefault(place, OpenNumber(place, setting.parameters[parameter], low, high))
    for one in update.corrections:
        if one.interval is not None:
            found.setdefault(one.key, OpenNumber(one.key, one.value, *one.interval))
    return tuple(number for number in found.values() if number.low <= number.value <= number.high and number.low < number.high)


def with_numbers(update: RigUpdate, values: Mapping[Place, float]) -> RigUpdate:
    """Return an update with other values of some numbers, their intervals unchanged."""
    return replace(update, parts=tuple(_moved(part, values) for part in update.parts), is_fitted_together=True)


def _moved(part: Part, values: Mapping[Place, float]) -> Part:
    entries = tuple(_entry(entry, values) for entry in part.entries)
    return replace(part, entries=entries, corrections=tuple(_correction(one, values) for one in part.corrections))


def _entry(entry: EffectEntry, values: Mapping[Place, float]) -> EffectEntry:
    setting = entry.setting
    moved = {p: values.get(("effects", setting.name, setting.where, p), value) for p, value in setting.parameters.items()}
    return replace(entry, setting=replace(setting, parameters=moved))


def _correction(one: Correction, values: Mapping[Place, float]) -> Correction:
    return replace(one, value=values.get(one.key, one.value))
