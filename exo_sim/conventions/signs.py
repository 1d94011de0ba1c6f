"""In which unit the clock runs, which column is of which chamber, and which way command and position count."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from exo_sim.conventions import clock
from exo_sim.conventions.check import Check, named
from exo_sim.conventions.clock import CLOCKS
from exo_sim.conventions.gas_balance import CylinderColumns, Explained, explained
from exo_sim.conventions.machine import Machine, columns_of
from exo_sim.conventions.positions import is_rate_of
from exo_sim.recording.table import Recording
from exo_sim.rig import Cylinder

#: What the balance must explain under another reading, and by what factor its misfit must fall.
_EXPLAINED, _BETTER = 0.6, 4.0
#: Readings whose misfits differ by less than this factor are rivals.
_RIVAL = 1.1
#: Share of the variance that command or motion alone must explain for it to say anything.
_SAYS = 0.05


@dataclass(frozen=True)
class _Reading:
    """Another way to read the columns of a cylinder: valve turned, chambers swapped, position from the other end, clock."""

    turned: bool = False
    swapped: bool = False
    reversed: bool = False
    clock: str = ""

    def of(self, columns: CylinderColumns, cylinder: Cylinder) -> CylinderColumns:
        columns = columns.with_turned_valve() if self.turned else columns
        columns = columns.swapped() if self.swapped else columns
        columns = columns.reversed(cylinder.stroke) if self.reversed else columns
        return columns.with_clock(CLOCKS[self.clock]) if self.clock else columns


_WAYS = [_Reading(turned=True), _Reading(swapped=True), _Reading(reversed=True)]


def in_order(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Put right a clock, swapped chambers and turned valves that the gas balance shows beyond doubt; refuse a reversed position."""
    found: dict[str, _Reading] = {}
    opened: dict[str, float] = {}
    fits = False
    for link in machine.links:
        columns, cylinder = columns_of(recording, machine, link), machine.cylinder(link)
        if columns is None:
            continue
        reading, under = _read(columns, cylinder, partial(explained, cylinder=cylinder, rig=machine.rig))
        if reading:
            found[link.cylinder], opened[link.cylinder] = reading, under.opened
        else:
            fits = fits or (under.share > _EXPLAINED and under.driven > _SAYS and clock.is_near(under.opened))
    checks: list[Check] = []
    clocks = {reading.clock for reading in found.values()} - {""}
    if len(clocks) == 1:
        (unit,) = clocks
        of_clock = [name for name, reading in found.items() if reading.clock]
        if fits or not all(clock.is_shown(recording, CLOCKS[unit], opened[name]) for name in of_clock):
            factor = CLOCKS[unit] * opened[of_clock[0]]
            return recording, [clock.either(recording, "" if fits else unit, of_clock, factor, machine.rig)]
        recording, check = _with_clock(recording, unit)
        checks.append(check)
    for name, reading in found.items():
        recording, more = _put_right(recording, machine, name, reading)
        checks += more
    return recording, checks


def _read(
    columns: CylinderColumns, cylinder: Cylinder, ask: Callable[[CylinderColumns], Explained]
) -> tuple[_Reading | None, Explained]:
    """Return the one other reading under which the pressures follow, and what is explained under it.

    None where they follow as they stand, or under none, and what is explained as they stand.
    """
    plain = ask(columns)
    if not plain.intervals:
        return None, plain
    driven = cylinder.valve_area > 0.0 and any(bool((columns.towards(side) != columns.towards(side)[0]).any()) for side in (0, 1))
    ways = [way for way in _WAYS if (driven or not way.turned) and not (cylinder.single_acting and way.swapped)]
    if driven:
        ways += [_Reading(clock=clock) for clock in CLOCKS]
        ways += [replace(way, clock=clock) for way in _WAYS if not (cylinder.single_acting and way.swapped) for clock in ("milliseconds",)]
    ranked = sorted(((ask(way.of(columns, cylinder)), way) for way in ways), key=lambda pair: -pair[0].share)
    best, way = ranked[0]
    if best.share < _EXPLAINED or plain.misfit < _BETTER * best.misfit:
        return None, plain
    if way.clock:  # two clocks whose valves lie within the bounds explain the same: the rig's own valve tells
        like = [pair for pair in ranked if pair[1].clock and pair[0].misfit < _RIVAL * best.misfit]
        clocks = [(found, other) for found, other in like if replace(other, clock=way.clock) == way]
        best, way = min(clocks, key=lambda pair: abs(math.log(pair[0].opened)))
    rivals = [other for found, other in ranked if other != way and found.misfit < _RIVAL * best.misfit]
    if not driven and rivals:  # chambers swapped or position reversed: without a valve both explain the same
        return None, plain
    return (way, best) if not rivals or best.worked > _SAYS else (None, plain)


def _with_clock(recording: Recording, unit: str) -> tuple[Recording, Check]:
    factor = CLOCKS[unit]
    columns = {key: values / factor if _is_rate(recording, key) else values for key, values in recording.columns.items()}
    says = (
        f'"time" goes over {recording.duration:.4g} s in {len(recording.time)} rows, at which the pressures would follow no valve of '
        f"this machine; was it written in {unit}? Taken as {unit}"
    )
    breaks = tuple(factor * at for at in recording.breaks)
    return replace(recording, time=factor * recording.time, columns=columns, breaks=breaks), Check("unit", ("time",), says)


def _is_rate(recording: Recording, key: str) -> bool:
    """Return whether a column is the rate of another as the clock stands, so that it was computed with the clock's unit."""
    part, _, signal = key.rpartition(".")
    position = recording.get(f"{part}.position")
    return signal == "velocity" and position is not None and is_rate_of(recording[key], position, recording.time)


def _put_right(recording: Recording, machine: Machine, name: str, reading: _Reading) -> tuple[Recording, list[Check]]:
    columns, checks = dict(recording.columns), []
    if reading.turned:
        cylinder = machine.rig.cylinders[name]
        keys = tuple(key for command in cylinder.commands if (key := f"{name}.{command}") in columns)
        columns |= {key: -columns[key] for key in keys}
        wrong = "open its chamber to the exhaust" if cylinder.valve.independent else "open the supply to chamber 2"
        says = f"{named(keys)}: does +1 {wrong} here? Its opposite moves the pressures as recorded; sign turned"
        checks.append(Check("turned valve", keys, says))
    if reading.swapped:
        keys = (f"{name}.pressure_1", f"{name}.pressure_2")
        both = [columns.pop(key, None) for key in keys]
        columns |= {key: values for key, values in zip(keys, reversed(both)) if values is not None}
        says = f"{named(keys)}: are the chambers swapped? Each behaves as the other's column should; taken the other way round"
        checks.append(Check("swapped chambers", keys, says))
    if reading.reversed:
        key = next(f"{link.joint}.position" for link in machine.links if link.cylinder == name)
        says = (
            f'"{key}": chamber 1 of {name} shrinks where its piston goes out; does the position count from the other end? Turn the sign '
            "of the column or of the joint's axis, or set retracted_length and gear right"
        )
        checks.append(Check("sign", (key,), says, refused=True))
    return replace(recording, columns=columns), checks
