"""From a column's heading to a signal: `<part>.<signal> [<unit>]` to key, SI unit, scale and offset."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from exo_sim import signals, units
from exo_sim.errors import RecordingError, UnitError, nearest

TIME = "time"
#: Longest heading that is read, in characters.
LONGEST = 300
_HEADING = re.compile(r"^\s*(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*$")
_SPELLINGS = {"-": "1", "": "1"}


@dataclass(frozen=True)
class Column:
    """Where a signal stands in a file and how its numbers become SI: `si = value * scale + offset`."""

    source: str
    key: str
    unit: str
    scale: float = 1.0
    offset: float = 0.0

    def to_si(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return values in `unit`, converted in place where that is possible."""
        if self.scale == 1.0 and self.offset == 0.0:
            return values
        if not values.flags.writeable:
            values = values.copy()
        values *= self.scale
        values += self.offset
        return values


def split(heading: str) -> tuple[str, str | None]:
    """Return `("piston.pressure_1", "Pa")` for `"piston.pressure_1 [Pa]"`; the unit is None where there is none.

    Raises:
        RecordingError: brackets that do not make sense.
    """
    if len(heading) > LONGEST:
        raise RecordingError(f'the column name "{heading[:40]}..." has {len(heading)} characters; at most {LONGEST} are read')
    match = _HEADING.match(heading)
    if match is None:
        raise RecordingError(f'cannot read the column name "{heading}"; write it like "piston.pressure_1 [Pa]"')
    return match["name"], match["unit"]


@lru_cache(maxsize=4096)
def signal_of(name: str) -> signals.Signal:
    """Return the signal that `"<part>.<signal>"` names.

    Raises:
        RecordingError: no such signal; the message offers the nearest.
    """
    part, _, signal_name = name.rpartition(".")
    if not part or not signal_name:
        known = sorted({signal.name for signal in signals.TABLE if signal.measured})
        raise RecordingError(
            f'column "{name}" is not of the form "<part>.<signal> [<unit>]": name it so, or hand in a column map{nearest(name, known)}'
        )
    if part in signals.SHARED_PARTS:
        known = list(signals.names(part))
        found = signals.find(part, signal_name)
    else:
        known = sorted({s.name for s in signals.TABLE if s.part not in signals.SHARED_PARTS})
        found = next((s for s in signals.TABLE if s.name == signal_name and s.part not in signals.SHARED_PARTS), None)
    if found is None:
        near = nearest(signal_name, known)
        listed = near if part in signals.SHARED_PARTS or "mean" in near else " (docs/recordings.md lists them)"
        raise RecordingError(f'column "{name}": no signal is called "{signal_name}"{listed}')
    return found


def resolve(heading: str) -> Column:
    """Read a heading of the contract.

    Raises:
        RecordingError: no such signal, or no unit.
        UnitError: the unit is unknown, gauge, or of another kind than the signal.
    """
    name, unit = split(heading)
    if name == TIME:
        return _column(heading, name, unit, ("s",))
    return _column(heading, name, unit, signal_of(name).units)


def _column(heading: str, name: str, unit: str | None, allowed: tuple[str, ...]) -> Column:
    wanted = " or ".join(f'"{name} [{each}]"' for each in allowed)
    if unit is None:
        if allowed == ("1",):
            return Column(heading, name, "1")
        raise UnitError(f'column "{heading}" has no unit; write {wanted}')
    unit = _SPELLINGS.get(unit.strip(), unit.strip())
    if unit in allowed:
        return Column(heading, name, unit)
    refusals = []
    for si_unit in allowed:
        try:
            scale, offset = units.scale_and_offset(unit, si_unit)
        except UnitError as error:
            refusals.append(error)
            continue
        return Column(heading, name, si_unit, scale, offset)
    if units.is_gauge(unit) and "Pa" in allowed:
        raise UnitError(f'column "{heading}": {refusals[0]}{_lifted(name, units.without_gauge(unit))}')
    scaled = f'; a column map can say how many are one: {{ column = "{name}", scale = 0.1 }}' if allowed == ("1",) else ""
    raise UnitError(f'column "{heading}": {refusals[0]}{scaled}')


def _lifted(name: str, unit: str) -> str:
    """Return how a column map makes a gauge column absolute, with the standard atmosphere in its unit."""
    try:
        atmosphere = 101325.0 / units.scale_and_offset(unit, "Pa")[0]
    except UnitError:  # in the wrong case
        return ""
    return f', or have a column map do it: {{ column = "{name} [{unit}]", offset = {atmosphere:.6g} }}'


def heading(key: str, unit: str) -> str:
    """Return the contract's heading of a column: `"piston.pressure_1 [Pa]"`."""
    return f"{key} [{unit}]"
