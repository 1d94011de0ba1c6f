"""Where a cylinder goes beyond what it is made for: its pressure rating, the ends of its stroke, and cold in which ports ice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.rig.catalogue import RATED_PRESSURE, find
from exo_sim.rig.schema import Cylinder, Rig

#: Part of the stroke that should stay unused at each end [m].
LEAST_LEFT = 1e-3
#: Below this the water of air that was not dried freezes in the chamber, its port and its silencer [K].
FREEZING = 273.15

_NONE = np.full(1, np.nan)


@dataclass(frozen=True)
class Reached:
    """The most that a cylinder saw: largest pressure [Pa], lowest temperature [K], least stroke left at an end [m]; None where unknown."""

    pressure: float | None = None
    temperature: float | None = None
    stroke_left: float | None = None


def rating(rig: Rig, cylinder: Cylinder) -> tuple[float, str] | None:
    """Return the largest pressure that a cylinder may see, absolute [Pa], and who says so; None where nobody does."""
    if cylinder.rating is not None:
        return cylinder.rating, "its rig gives"
    entry = find(cylinder.bore, cylinder.rod)
    return None if entry is None else (RATED_PRESSURE + rig.environment.pressure, f"{entry.standard} rates")


def reached_in(rig: Rig, columns: Mapping[str, NDArray[np.float64]]) -> dict[str, Reached]:
    """Return what each cylinder saw in columns named `"<part>.<signal>"`, as far as they say it."""
    out = {}
    for name, cylinder in rig.cylinders.items():
        pressures = [np.nanmax(columns[key]) for side in (1, 2) if np.isfinite(columns.get(key := f"{name}.pressure_{side}", _NONE)).any()]
        cold = [np.nanmin(columns[key]) for side in (1, 2) if np.isfinite(columns.get(key := f"{name}.temperature_{side}", _NONE)).any()]
        length = columns.get(f"{name}.length", _NONE)
        left = None
        if np.isfinite(length).any():
            left = float(min(np.nanmin(length), cylinder.stroke - np.nanmax(length)))
        out[name] = Reached(float(max(pressures)) if pressures else None, float(min(cold)) if cold else None, left)
    return out


def passed(rig: Rig, reached: Mapping[str, Reached]) -> tuple[str, ...]:
    """Return a sentence for each kind of limit that cylinders passed, by what each of them reached."""
    pressures, ends, cold = [], [], []
    for name, one in reached.items():
        allowed = rating(rig, rig.cylinders[name])
        if allowed is not None and one.pressure is not None and one.pressure > allowed[0]:
            pressures.append(f"{name} {one.pressure / 1e5:.1f} bar where {allowed[1]} {allowed[0] / 1e5:.1f}")
        if one.stroke_left is not None and one.stroke_left < LEAST_LEFT:
            ends.append(f"{name} {'is pushed' if one.stroke_left < 0.0 else 'comes'} {_end(one.stroke_left)} its end")
        if one.temperature is not None and one.temperature < FREEZING:
            cold.append(f"{name} {one.temperature - FREEZING:.0f} C")
    out = []
    if pressures:
        out.append(f"pressure above the rating: {'; '.join(pressures)} (absolute)")
    if ends:
        out.append(f"stroke used up: {'; '.join(ends)}; give it more stroke or another retracted_length")
    if cold:
        out.append(f"gas below freezing: {', '.join(cold)}; dry the air to a pressure dew point below that, or ports and silencers ice up")
    return tuple(out)


def _end(left: float) -> str:
    return f"{-1e3 * left:.1f} mm beyond" if left < 0.0 else f"within {1e3 * left:.1f} mm of"
