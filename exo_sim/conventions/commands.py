"""Commands that do not say what the valve did: a column that never opens it while chambers fill, or one on a clock of its own.

Physics cannot precede its cause. Lags of valves, lines and pressure sensors let pressures come after their command; where pressures follow
it far better with the command taken earlier, its column is late. A command in pulses repeats itself: taken earlier by a part of their
period it is what it is taken later by the rest, and a valve that lags needs no other clock.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions import limits
from exo_sim.conventions.check import Check, named
from exo_sim.conventions.fed_chambers import fed_cylinders, volumes
from exo_sim.conventions.gas_balance import CylinderColumns, Explained, explained
from exo_sim.conventions.machine import Machine, columns_of
from exo_sim.recording.table import Recording

#: Changes of closed chambers are looked at over this time [s].
CLOSED_SPAN = 0.04
#: What a check of a late command is called.
LATE_COMMAND = "late command"


def that_open(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Set aside commands that never open a valve through which a chamber was fed again and again."""
    silent = {
        name: keys
        for name, cylinder in machine.rig.cylinders.items()
        if (keys := tuple(key for command in cylinder.commands if (key := f"{name}.{command}") in recording))
        and all(never_opens(recording[key]) for key in keys)
    }
    if not silent:
        return recording, []
    unsaid = {key for keys in silent.values() for key in keys}
    rest = replace(recording, columns={key: values for key, values in recording.columns.items() if key not in unsaid})
    fed = fed_cylinders(rest, machine.rig, machine.model) - _closed_and_late(recording, machine)
    gone = {key for name in silent if name in fed for key in silent[name]}
    checks = []
    for name in (name for name in silent if name in fed):
        most = max(float(np.nanmax(np.abs(recording[key]))) for key in silent[name])
        says = (
            f"{named(silent[name])}: {most:.2g} at most, which opens no valve, while a chamber of {name} is filled again and again: the "
            "column does not say what the valve did. Set aside: record the command that the valve gets"
        )
        checks.append(Check("command", silent[name], says))
    return replace(recording, columns={key: values for key, values in recording.columns.items() if key not in gone}), checks


def _closed_and_late(recording: Recording, machine: Machine) -> frozenset[str]:
    """Return the cylinders whose pressures follow their volumes as closed chambers' do, however late: such a command is believed."""
    found, time = set(), recording.time
    grid = np.arange(time[0], time[-1], CLOSED_SPAN)
    for link in machine.links:
        cylinder, position = machine.cylinder(link), recording.get(f"{link.joint}.position")
        measured = [(side, one) for side in (0, 1) if (one := recording.get(f"{link.cylinder}.pressure_{side + 1}")) is not None]
        if position is None or not measured or len(grid) < 3:
            continue
        volume = volumes(cylinder, machine.piston(link, position))
        good = np.isfinite(volume).all(axis=0)
        present = [(side, one, np.isfinite(one)) for side, one in measured if np.isfinite(one).any()]
        changes = [np.diff(np.log(np.maximum(np.interp(grid, time[ok], one[ok]), 1.0))) for _, one, ok in present]
        for late in np.arange(0.0, limits.CARDS_LATE, CLOSED_SPAN / 2.0):
            shrunk = [-np.diff(np.log(np.interp(grid - late, time[good], volume[side][good]))) for side, _, _ in present]
            follows = [_follows(change, one, machine.rig.heat_capacity_ratio) for change, one in zip(changes, shrunk, strict=True)]
            if min(follows, default=0.0) > limits.FOLLOWS:
                found.add(link.cylinder)
                break
    return frozenset(found)


def _follows(change: NDArray[np.float64], shrunk: NDArray[np.float64], k: float) -> float:
    """Return which share of the squares of changes of ln p those of -ln V explain, between isothermal and isentropic."""
    exponent = min(max(float(change @ shrunk) / max(float(shrunk @ shrunk), 1e-300), 1.0), k)
    rest = change - exponent * shrunk
    return 1.0 - float(rest @ rest) / max(float(change @ change), 1e-300)


def never_opens(values: NDArray[np.float64]) -> bool:
    """Return whether a command that was recorded opens no valve."""
    return bool(np.isfinite(values).any()) and float(np.nanmax(np.abs(values))) < limits.OPENS


def in_time(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Take commands earlier that the pressures precede; the end of the recording, whose command is not in it, is left out."""
    late: dict[tuple[str, ...], float] = {}
    for link in machine.links:
        columns, cylinder = columns_of(recording, machine, link), machine.cylinder(link)
        keys = tuple(key for command in cylinder.commands if (key := f"{link.cylinder}.{command}") in recording)
        if columns is None or not keys or cylinder.valve_area <= 0.0:
            continue
        seconds = _lateness(columns, partial(explained, cylinder=cylinder, rig=machine.rig))
        if seconds:
            late[keys] = seconds
    if not late:
        return recording, []
    moved, checks, time = dict(recording.columns), [], recording.time
    for keys, seconds in late.items():
        for key in keys:
            moved[key] = _earlier(recording[key], time, seconds)
        says = (
            f"{named(keys)}: the pressures precede it by {1e3 * seconds:.3g} ms, and no machine moves before its command: is the column "
            f"on another clock? Taken {1e3 * seconds:.3g} ms earlier"
        )
        checks.append(Check(LATE_COMMAND, keys, says, value=seconds))
    whole = replace(recording, columns=moved)
    return whole.span(time[0], time[-1] - max(late.values())), checks


def _lateness(columns: CylinderColumns, ask: partial[Explained]) -> float:
    """Return by how much a command comes after what it does [s]; 0 where it does not."""
    step = float(np.median(np.diff(columns.time)))
    least = max(limits.LATE, 3.0 * step)
    plain = ask(columns)
    if not plain.intervals or ask(_with_earlier(columns, least)).misfit >= plain.misfit:
        return 0.0

    def misfit(seconds: float) -> float:
        return ask(_with_earlier(columns, seconds)).misfit

    width = max(0.5 * least, step)
    best = min(np.arange(least, limits.LATEST, width).tolist(), key=misfit)
    while width > step:
        width = max(0.5 * width, step)
        best = min((best - width, best, best + width), key=misfit)
    found = ask(_with_earlier(columns, best))
    needed = limits.BETTER_IN_TIME * found.misfit
    if best < least or found.share <= limits.FOLLOWED or plain.misfit <= needed:
        return 0.0
    lags = np.arange(least, limits.LATEST, max(0.5 * least, step)).tolist()
    return 0.0 if any(misfit(-lag) <= needed for lag in lags) else float(best)


def _with_earlier(columns: CylinderColumns, seconds: float) -> CylinderColumns:
    """Return what it is where commands are those of so much later, within each stretch."""
    first, second = columns.command.copy(), None if columns.command_2 is None else columns.command_2.copy()
    edges = [*columns.breaks.tolist(), len(columns.time)]
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        time = columns.time[begin:end]
        first[begin:end] = _earlier(columns.command[begin:end], time, seconds)
        if second is not None and columns.command_2 is not None:
            second[begin:end] = _earlier(columns.command_2[begin:end], time, seconds)
    return replace(columns, command=first, command_2=second)


def _earlier(values: NDArray[np.float64], time: NDArray[np.float64], seconds: float) -> NDArray[np.float64]:
    """Return the value that is held so much later, shape (n,)."""
    half = 0.5 * float(np.median(np.diff(time)))
    return np.asarray(values[np.maximum(np.searchsorted(time, time + seconds + half) - 1, 0)])
