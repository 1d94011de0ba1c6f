"""Does an effect matter? What predictions miss when the true machine is used without it, everything else fitted again.

Windows of half a second start from the true state and are driven by the same commands, with and without the effect. What numbers of the
machine, offsets of its sensors and the start of each window can make up for is taken out (one Gauss-Newton step with the spread that a
data sheet leaves to each number). What remains, over the windows' length, is given in units of what an owner can see of each signal:
its noise and steps, and two thousandths of its own spread.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.trials.whole_machines.draw import Built
from exo_sim.trials.whole_machines.hidden_effects import BLOCKS
from exo_sim.trials.whole_machines.instruments import Rack
from exo_sim.trials.whole_machines.machine import Machine
from exo_sim.trials.whole_machines.machine_run import Run, replayed
from exo_sim.trials.whole_machines.plant import N1, N2, QD, U1, U2

Array = NDArray[np.float64]

WINDOW = 0.5
#: Seconds of windows that are looked at.
_LOOKED_AT = 5.0
SIGNALS = ("pressure_1", "pressure_2", "position", "force")
#: Relative spread that a data sheet leaves; what is not named has that of an effect of unknown size.
_SHEET = {"valve_area": 0.1, "dead_1": 0.2, "dead_2": 0.2, "inertia": 0.05, "supply": 0.02, "area_1": 0.01}
_FREE = 0.5
#: Offsets that pressures and load cells may have, in units of what can be seen.
_OFFSET = 3.0
_NOT_NUMBERS = {"flow_law", "hose_kind", "flow_m", "flow_laminar", "crack", "stribeck_exponent", "viscous_index", "leak_inertial",
                "leak_turning", "place_phase", "spool_damping", "hose_heat", "hose_b", "exhaust_volume", "regulator_overshoot",
                "tank_heat"}  # fmt: skip


@dataclass(frozen=True)
class Seen:
    """Windows of a run that are looked at.

    Attributes:
        resets: See `loop.run`.
        rows: Samples that count, shape (windows, length).
        unit: What can be seen of each signal of `SIGNALS`; infinite where it is not recorded.
    """

    resets: NDArray[np.int64]
    rows: NDArray[np.int64]
    unit: Array


def windows(truth: Run, rack: Rack, columns: Sequence[str]) -> Seen:
    """Choose the windows and say what can be seen in them."""
    time = truth.time
    length = max(8, round(WINDOW / float(np.median(np.diff(time)))))
    starts = np.arange(0, len(time) - length, length)
    every = max(1, round(len(starts) * WINDOW / _LOOKED_AT))
    starts = starts[::every]
    resets = np.full(len(time), -1, np.int64)
    for start in starts:
        resets[start : start + length] = 0
        resets[start] = 1
    rows = starts[:, None] + np.arange(length)
    unit = np.array([
        math.hypot(getattr(rack, name).spread, 2e-3 * float(np.std(truth.at_samples(name)))) if name in columns else math.inf
        for name in SIGNALS
    ])  # fmt: skip
    return Seen(resets, rows, unit)


def matters(built: Built, truth: Run, rack: Rack, columns: Sequence[str], keys: Sequence[str]) -> dict[str, dict[str, float]]:
    """Return for each block what its absence changes: signal to multiples of what can be seen, `worst` the largest.

    Args:
        built: The machine.
        truth: A run with states.
        rack: Its instruments.
        columns: Signals that are recorded.
        keys: Of `hidden_effects.BLOCKS`, present in the machine.
    """
    m = built.machine
    seen = windows(truth, rack, columns)
    base = _predict(m, truth, seen, truth.states)
    locally = [_predict(m, truth, seen, states) - base for states in _moved_starts(truth, seen)]
    numbers = _numbers(built)
    found = {}
    slopes = {
        name: (_predict(m.with_(**{name: m[name] * 1.01}), truth, seen, truth.states) - base) / 0.01 * spread
        for name, spread in numbers.items()
    }
    for key in keys:
        change = _predict(m.without(*BLOCKS[key].off), truth, seen, truth.states) - base
        columns_ = [slope for name, slope in slopes.items() if name not in BLOCKS[key].off]
        left = _refitted(change, columns_, locally, len(SIGNALS))
        rms = np.sqrt(np.mean(left**2, axis=(0, 1)))
        entry = {name: float(value) for name, value in zip(SIGNALS, rms) if name in columns}
        found[key] = {**entry, "worst": max(entry.values(), default=0.0)}
    return found


def _predict(m: Machine, truth: Run, seen: Seen, starts: Array) -> Array:
    """Return predictions in units of what can be seen, shape (windows, length, signals)."""
    run = replayed(m, truth, starts, seen.resets)
    values = np.stack([run.at_samples(name)[seen.rows] for name in SIGNALS], axis=-1) / seen.unit
    return np.nan_to_num(np.clip(values, -1e7, 1e7))


def _moved_starts(truth: Run, seen: Seen) -> list[Array]:
    """Return the states with a start moved by about what an owner can know of it: pressures and speed."""
    moved = []
    for places in ((N1, U1), (N2, U2)):
        states = truth.states.copy()
        number = "1" if places[0] == N1 else "2"
        share = 0.3 * min(seen.unit[SIGNALS.index(f"pressure_{number}")], 5e3) / truth.at_samples(f"pressure_{number}")
        for place in places:
            states[:, place] *= 1.0 + share
        moved.append(states)
    states = truth.states.copy()
    states[:, QD] += 3.0 * min(seen.unit[SIGNALS.index("position")], 1e-3) / 0.02
    moved.append(states)
    return moved


def _numbers(built: Built) -> dict[str, float]:
    """Return the fields that are fitted again with the relative spread of each."""
    m = built.machine
    found = {name: spread for name, spread in _SHEET.items() if m[name] > 0}
    if m["gravity"] > 0:
        found["gravity"] = 0.05
    for key in (*built.hidden, *built.known):
        for name in BLOCKS[key].off:
            if name not in _NOT_NUMBERS and m[name] != 0.0:
                found[name] = _FREE if key in built.hidden else 0.1
    return found


def _refitted(change: Array, slopes: Sequence[Array], locally: Sequence[Array], signals: int) -> Array:
    """Return what is left of a change, shape (windows, length, signals), after numbers, offsets and starts made up for what they can."""
    count, length, _ = change.shape
    flat = change.reshape(count, -1)
    offsets = []
    for i in (0, 1, 3):
        unit = np.zeros((length, signals))
        unit[:, i] = _OFFSET
        offsets.append(np.broadcast_to(unit.ravel(), flat.shape))
    table = np.stack([*(slope.reshape(count, -1) for slope in slopes), *offsets], axis=-1)
    local = np.stack([one.reshape(count, -1) for one in locally], axis=-1)
    k = table.shape[-1]
    information, gain = np.eye(k), np.zeros(k)
    cleaned, cleaned_change = np.empty_like(table), np.empty_like(flat)
    for w in range(count):
        square = local[w].T @ local[w] + np.eye(local.shape[-1])
        cleaned[w] = table[w] - local[w] @ np.linalg.solve(square, local[w].T @ table[w])
        cleaned_change[w] = flat[w] - local[w] @ np.linalg.solve(square, local[w].T @ flat[w])
        information += table[w].T @ cleaned[w]
        gain += table[w].T @ cleaned_change[w]
    best = np.linalg.solve(information, gain)
    return (cleaned_change - cleaned @ best).reshape(change.shape)


def plain(found: Mapping[str, Mapping[str, float]], key: str) -> dict[str, float]:
    """Return one block's entry, rounded for a file."""
    return {name: float(f"{value:.4g}") for name, value in found[key].items()}
