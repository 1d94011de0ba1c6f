"""In which unit pressures were written, and from which zero they count."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from exo_sim.conventions import limits
from exo_sim.conventions.check import Check, named
from exo_sim.conventions.gas_balance import least_at, misfits_by_zero, worse_without
from exo_sim.conventions.machine import Machine, chamber_columns, columns_of
from exo_sim.recording import noise
from exo_sim.recording.table import Recording

Array = NDArray[np.float64]

#: Units that pressures are written in, in Pa; what stands under the heading of one may have been written in another.
UNITS = {"Pa": 1.0, "bar": 1e5, "kPa": 1e3, "psi": 6894.757293168361, "MPa": 1e6, "mbar": 1e2}


def in_pascal(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Convert pressures that cannot be in the unit of their heading; what is not certain stays as it is."""
    keys = [key for key in (*chamber_columns(recording, machine), "supply.pressure", "exhaust.pressure") if key in recording]
    odd = [key for key in keys if _is_odd(recording[key], recording.time, machine)]
    if any(key not in odd for key in chamber_columns(recording, machine)):
        odd = [key for key in odd if _ends(recording[key])[1] < limits.VACUUM]
    if not odd or machine.supply is None:
        return recording, []
    lows, highs = zip(*(_ends(recording[key]) for key in odd))
    found = _unit(min(lows), max(highs), machine)
    if found is None:
        return recording, []
    unit, factor = found
    columns = dict(recording.columns)
    for key in odd:
        columns[key] = factor * columns[key]
    says = (
        f"{named(tuple(odd))}: {max(highs):.4g} Pa at most is no pressure of this machine, whose supply is {machine.supply:.4g} Pa; "
        f"were they written in {unit}? Taken as {unit}: multiplied by {factor:.6g}"
    )
    return replace(recording, columns=columns), [Check("unit", tuple(odd), says)]


def _ends(values: Array) -> tuple[float, float]:
    present = values[np.isfinite(values)]
    return float(np.quantile(present, 0.01)), float(np.quantile(present, 0.995))


def _is_odd(values: Array, time: Array, machine: Machine) -> bool:
    if not np.isfinite(values).any():
        return False
    low, high = _ends(values)
    if high > limits.MOST * max(machine.supply or 0.0, machine.atmosphere):
        return True
    swing = high - low
    # a vented chamber that counts from the atmosphere shows nothing but noise
    return 0.0 < high < limits.LEAST * machine.atmosphere and (swing > 20.0 * noise.floor(values, time).std or low > 0.5 * high)


def _unit(low: float, high: float, machine: Machine) -> tuple[str, float] | None:
    """Return the unit in which the largest pressure comes nearest to the supply, and what the column must be multiplied with.

    The reader took the column in its heading's unit, so that of a column in `unit` under the heading of another the factor is the
    ratio of both. A load that is stopped compresses further than the supply.
    """
    return _nearest(low, high, machine, limits.NEAR_HIGH) or _nearest(low, high, machine, limits.MOST)


def _nearest(low: float, high: float, machine: Machine, times: float) -> tuple[str, float] | None:
    """Return `_unit` among those with which the largest pressure is no more than so many times the supply."""
    assert machine.supply is not None
    best: tuple[float, str, float] | None = None
    for heading, (unit, size) in product(UNITS.values(), UNITS.items()):
        factor = size / heading
        for lifted in (0.0, machine.atmosphere):
            most, least = factor * high + lifted, factor * low + lifted
            near = limits.NEAR_LOW * machine.supply <= most <= times * machine.supply
            if factor == 1.0 or not near or least < 0.5 * machine.atmosphere:
                continue
            far = abs(math.log(most / machine.supply)) + 0.3 * abs(math.log(least / machine.atmosphere))
            if best is None or far < best[0] - 1e-9:
                best = far, unit, factor
    return best[1:] if best else None


def absolute(recording: Recording, machine: Machine) -> tuple[Recording, list[Check]]:
    """Add the atmosphere to pressures that count from it.

    A chamber that vents rests at the atmosphere, or at nothing where its sensor counts from there; the gas balance of one that never
    does tells as well. Where all chambers that tell count from the atmosphere, all were written so; where only some do, a sensor
    differs from the others, and it is asked but not put right.
    """
    chambers = chamber_columns(recording, machine)
    shared = _shared(recording, machine)
    zeros = _zeros(_lifted(recording, shared, machine), machine, bool(shared))
    common = _common_zero(recording, machine) if shared else None
    kinds = {
        key: _counts_from(recording[key], recording.time, machine, _kind(zeros.get(key), common, bool(shared))) for key in chambers
    }
    if not shared and not any(kinds.values()) and _together_gauge(recording, machine):
        kinds = dict.fromkeys(kinds, "gauge")
    gauge = tuple(key for key, kind in kinds.items() if kind == "gauge")
    if gauge and "absolute" in kinds.values():
        says = (
            f"{named(gauge)}: gauge? It behaves as if counted from the atmosphere, and the other chambers do not; left as it is, "
            "as one sensor's fault"
        )
        return recording, [Check("gauge", gauge, says, left=True)]
    # a supply alone that is off by the atmosphere is the rig's number, or a sensor's fault, unless chambers stand above it
    lifted = (*chambers, *shared) if gauge else shared if _above(recording, machine) else tuple(k for k in shared if k != "supply.pressure")
    if not lifted:
        return recording, []
    says = (
        f"{named(lifted)}: are these gauge? They behave as if counted from the atmosphere, where the format has absolute pressures; "
        f"{machine.atmosphere:.6g} Pa were added"
    )
    return _lifted(recording, lifted, machine), [Check("gauge", lifted, says)]


def _lifted(recording: Recording, keys: Sequence[str], machine: Machine) -> Recording:
    return replace(recording, columns=dict(recording.columns) | {key: recording[key] + machine.atmosphere for key in keys})


def _zeros(recording: Recording, machine: Machine, supply_is_gauge: bool) -> dict[str, float]:
    """Return what must be added to each chamber's pressure for its gas balance to hold best beside the supply as it stands.

    In atmospheres, where the balance tells: one that holds best with an atmosphere added also holds better with it than without,
    plainly so where no supply counts from the atmosphere.
    """
    found = {}
    for key, misfits in _misfits(recording, machine, with_supply=False).items():
        zero = least_at(misfits, limits.CONTRAST)
        if zero is not None and (zero < limits.ABSOLUTE or worse_without(misfits) > (1.0 if supply_is_gauge else limits.CONTRAST)):
            found[key] = zero
    return found


def _together_gauge(recording: Recording, machine: Machine) -> bool:
    """Return whether all chambers that tell hold better with an atmosphere added, together plainly so; False where fewer than two tell."""
    factors = [worse_without(misfits) for misfits in _misfits(recording, machine, with_supply=False).values()]
    return len(factors) > 1 and min(factors) > 1.0 and math.prod(factors) > limits.TOGETHER


def _common_zero(recording: Recording, machine: Machine) -> float | None:
    """Return what must be added to all pressures, the supply's too, in atmospheres; None where the balances do not tell."""
    misfits = list(_misfits(recording, machine, with_supply=True).values())
    return least_at(np.sum(misfits, axis=0), limits.COMMON_CONTRAST) if misfits else None


def _misfits(recording: Recording, machine: Machine, with_supply: bool) -> dict[str, Array]:
    found = {}
    for link in machine.links:
        columns, cylinder = columns_of(recording, machine, link), machine.cylinder(link)
        if columns is None or cylinder.valve_area <= 0.0:
            continue
        for chamber in (0,) if cylinder.single_acting else (0, 1):
            misfits = misfits_by_zero(columns, cylinder, machine.rig, chamber, with_supply)
            if misfits is not None:
                found[f"{link.cylinder}.pressure_{chamber + 1}"] = misfits
    return found


def _kind(zero: float | None, common: float | None, supply_is_gauge: bool) -> str:
    """Return from where a pressure counts whose balance holds best with `zero` atmospheres added, all pressures' with `common`."""
    if zero is None:
        return ""
    least = limits.GAUGE_BESIDE if supply_is_gauge else limits.GAUGE
    if supply_is_gauge and common is not None and common < limits.COMMON:
        return "absolute"  # the rig's supply is off by the atmosphere, not the columns
    return "gauge" if least < zero < limits.MOST_GAUGE else "absolute" if abs(zero) < limits.ABSOLUTE else ""


def _counts_from(values: Array, time: Array, machine: Machine, by_balance: str) -> str:
    """Return from where a pressure counts: as where it rests shows, else as its gas balance does.

    One that no more than passes the atmosphere at its least rests nowhere: a gauge column of a chamber that never vents may.
    """
    rests = _rests_at(values, time, machine)
    if rests == "absolute" and by_balance == "gauge":
        there = np.abs(values[np.isfinite(values)] - machine.atmosphere) < limits.RESTS * machine.atmosphere
        return "absolute" if float(np.mean(there)) > limits.DWELLS else "gauge"
    return rests or by_balance


def _rests_at(values: Array, time: Array, machine: Machine) -> str:
    """Return from where a pressure counts, as far as where it rests shows it: "gauge", "absolute" or ""."""
    present = values[np.isfinite(values)]
    if not len(present):
        return ""
    slack = limits.RESTS * machine.atmosphere
    low = float(np.quantile(present, 0.01))
    if float(present.max()) < 3.0 * slack and float(np.ptp(present)) == 0.0:
        return ""  # a dead sensor, or a chamber that nobody measured
    if low < -5.0 * noise.floor(values, time).std - 0.005 * float(np.ptp(present)):
        return "gauge"
    rests = float(np.mean(np.abs(present) < slack))
    if low < slack and rests > 0.02:
        return "gauge"
    return "absolute" if abs(low - machine.atmosphere) < slack else ""


def _shared(recording: Recording, machine: Machine) -> tuple[str, ...]:
    """Return which of the pressures of supply and exhaust look as if counted from the atmosphere."""
    found = []
    supply, exhaust = recording.get("supply.pressure"), recording.get("exhaust.pressure")
    if supply is not None and machine.supply is not None:
        usual = float(np.nanquantile(supply, limits.FULL))  # where it sags it is below what it is set to
        if abs(usual + machine.atmosphere - machine.supply) < limits.OFF_BY * machine.atmosphere:
            found.append("supply.pressure")
    if exhaust is not None and abs(float(np.nanmedian(exhaust))) < limits.RESTS * machine.atmosphere:
        found.append("exhaust.pressure")
    return tuple(found)


def _above(recording: Recording, machine: Machine) -> bool:
    """Return whether chambers stand above what is said to supply them by about the atmosphere."""
    supply = recording.get("supply.pressure")
    chambers = chamber_columns(recording, machine)
    if supply is None:
        return False
    return max((float(np.nanquantile(recording[key] - supply, 0.98)) for key in chambers), default=0.0) > 0.6 * machine.atmosphere
