"""In which unit a clock runs, as far as a recording shows it by itself.

Over a clock that runs c times as fast a valve lets c times as much through, and so does one of c times the area, or one at chambers so much
smaller: a gas balance cannot tell a unit of time from a wrong size in the rig. What can is beside the rig: a rate that no logger has, or a
recorded velocity.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from exo_sim.conventions.check import Check
from exo_sim.conventions.positions import is_rate_of
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig

#: What a clock under the heading of seconds may have been written in, and how long its unit is [s].
CLOCKS: Mapping[str, float] = {
    "milliseconds": 1e-3, "microseconds": 1e-6, "minutes": 60.0, "seconds, not milliseconds": 1e3, "seconds, not microseconds": 1e6
}  # fmt: skip
#: Rates [Hz] of whoever records gas: slower than that a chamber fills between samples; faster than that pressure sensors show nothing.
#: Asserted: the rates of the recordings at hand are 50 Hz to 10 kHz.
SLOWEST, FASTEST = 25.0, 20e3
#: Usual rates and periods begin with these, to within so much: minutes taken for seconds turn none of them into another (nearest: 4 %).
USUAL, NEAR = (1.0, 1.25, 2.0, 2.5, 4.0, 5.0, 8.0, 10.0), 0.01
#: A valve may be off by so much beside a clock in another unit. Data sheets of valves are off by a factor of 2 at most; "32 cm" for "32 mm"
#: leaves 1.5 beside minutes, "cm^2" for "mm^2" 10 beside milliseconds.
LEFT = 3.0


def is_shown(recording: Recording, factor: float, opened: float) -> bool:
    """Return whether a recording shows, beside the sizes of the rig, that its clock runs in a unit of `factor` seconds.

    Args:
        recording: With the clock as it stands.
        factor: Length of the unit [s].
        opened: Factor of the rig's valve that is then left.
    """
    if not is_near(opened):
        return False
    step = float(np.median(np.diff(recording.time)))
    return (not _is_usual(step) and _is_usual(factor * step)) or _moves_so(recording, factor)


def is_near(opened: float) -> bool:
    """Return whether a valve that is so many times the rig's is the rig's, as far as data sheets tell."""
    return 1.0 / LEFT < opened < LEFT


def either(recording: Recording, unit: str, cylinders: Sequence[str], factor: float, rig: Rig) -> Check:
    """Refuse a clock that may be in another unit, where the rig's sizes may be wrong as well.

    Args:
        recording: With the clock as it stands.
        unit: In which the clock may be; "" where it is known to be right.
        cylinders: Whose pressures do not follow.
        factor: By how much more gas must have passed than their valves let through.
        rig: Whose sizes they are.
    """
    size = float(f"{max(factor, 1.0 / factor):.2g}")
    times = f"{size:g} times {'faster' if factor > 1.0 else 'slower'}"
    tables = " and ".join(f"cylinders.{name}" for name in cylinders)
    says = (
        f'"time" goes over {recording.duration:.4g} s in {len(recording.time)} rows, in which pressures change {times} than the valve of '
        f"{' and '.join(cylinders)} lets them: "
    )
    sizes = f"bore, dead volumes or valve area in {tables} of {rig.path}"
    if not unit:
        return Check("size", ("time",), says + f"the clock fits the other cylinders, so correct {sizes}", refused=True)
    return Check("clock", ("time",), says + f"is the column in {unit} and its heading wrong, or {sizes}? Correct one of them", refused=True)


def _is_usual(step: float) -> bool:
    """Return whether somebody records so: one sample every `step` [s]."""
    if not 1.0 / ((1.0 + NEAR) * FASTEST) <= step <= (1.0 + NEAR) / SLOWEST:
        return False
    begins = step / 10.0 ** math.floor(math.log10(step))
    return any(abs(begins / usual - 1.0) < NEAR for usual in USUAL)


def _moves_so(recording: Recording, factor: float) -> bool:
    """Return whether a recorded velocity is the rate of its position with the clock in another unit, and is not as it stands."""
    for key, velocity in recording.columns.items():
        part, _, signal = key.rpartition(".")
        position = recording.get(f"{part}.position") if signal == "velocity" else None
        if position is None or is_rate_of(velocity, position, recording.time):
            continue
        if is_rate_of(velocity, position, factor * recording.time):
            return True
    return False
