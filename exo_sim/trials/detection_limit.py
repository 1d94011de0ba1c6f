"""The smallest size of an effect that any method could find: a likelihood-ratio test that knows its true form.

The recording is cut into windows. In each, the machine without the effect starts from the true state and is driven by
the same command; what it misses is held against the instruments' noise, after taking out whatever a free start of each
window and the owner's uncertainty about the machine could explain as well, each a Gaussian of known width. The root of
the likelihood ratio that remains is `distance`, in standard deviations; found in nine of ten at 1 % false alarms
(two-sided) needs 3.86: the *ideal* limit, that of a machine without any imperfection.

Every healthy machine has a little of everything. The *limit* that sizes are counted in adds 3.86 times
`Effect.healthy`, the size that benches of a careful laboratory show, in quadrature to the ideal one.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.outputs import replacing
from exo_sim.progress import each
from exo_sim.trials.cases import COLUMNS, Case, instrument_of, make_case
from exo_sim.trials.conditions import Conditions
from exo_sim.trials.hidden_effects import EFFECTS, find
from exo_sim.trials.truth.drive import Truth, advance
from exo_sim.trials.truth.excitation import Program
from exo_sim.trials.truth.instruments import Instrument, measure
from exo_sim.trials.truth.machine import Machine
from exo_sim.trials.truth.state import M1, M2, STATES, T1, T2, VL, VP, XL, XP

Array = NDArray[np.float64]

_REFERENCE = Path(__file__).with_name("limits.json")
#: 2.576 (1 % false alarms, two-sided) + 1.282 (nine in ten found).
NEEDED = 3.858
WINDOW = 1.2
CHANNELS = ("pressure_1", "pressure_2", "position", "supply")
#: Every this many samples, and every second window, enters the comparison, with the weight of those left out.
STRIDE = 5
#: Field to its relative standard deviation: what a careful owner does not know better.
UNCERTAIN = {"valve_area": 0.02, "dead_1": 0.05, "dead_2": 0.05, "load_mass": 0.005, "heat_conductance": 0.01,
             "coulomb": 0.01, "viscous": 0.01}  # fmt: skip
#: What an owner may tune besides, to hide what is missing.
TUNED = {**UNCERTAIN, "damping": 0.05}
#: Offsets of good sensors, one standard deviation [Pa], [m].
OFFSETS = {"pressure_1": 500.0, "pressure_2": 500.0, "position": 5e-5}
_STATE_STEPS = ((XP, 2e-5), (VP, 1e-4), (M1, 3e-4), (T1, 3e-4), (M2, 3e-4), (T2, 3e-4))


def _predict(machine: Machine, states: Array, command: Array, ticks: NDArray[np.int64], dt: float) -> Array:
    """Return what the machine does in one window, (pressure_1, pressure_2, position, supply), shape (n, 4)."""
    n = len(command)
    nothing = np.zeros(n)
    plan = Program(np.zeros(n, np.int64), nothing, nothing, command)
    y, bristle, start = states[:STATES].copy(), states[STATES : STATES + 4].copy(), states[STATES + 4]
    if machine["drive_stiffness"] == 0.0:
        y[XP], y[VP] = y[XL], y[VL]
    log = advance(machine, y, bristle, start, ticks, dt, plan, np.zeros(4), nothing).log
    return np.column_stack([log[name] for name in CHANNELS])


def _noise(one: Instrument) -> float:
    """Return white noise and quantisation together, one standard deviation."""
    step = (one.high - one.low) / (2**one.bits - 1) if one.bits else 0.0
    return math.hypot(one.noise, step / math.sqrt(12))


@dataclass(frozen=True)
class Evidence:
    """What the windows of a case say about the machine without what is hidden, in units of noise and uncertainty.

    Attributes:
        names: The uncertain numbers, in the order of the rest.
        information: Their information matrix, shape (k, k), the owner's prior not included.
        gain: Their gradient, shape (k,).
        total: Squared misfit of the machine as it is, starts taken out.
    """

    names: tuple[str, ...]
    information: Array
    gain: Array
    total: float


def evidence(case: Case, uncertain: Mapping[str, float] = UNCERTAIN) -> Evidence:
    """Return the evidence of a case against the same bench with nothing hidden.

    Args:
        case: Drawn with `keep_states=True`.
        uncertain: Field to the relative standard deviation that the owner leaves it.
    """
    plain = case.bench.machine()
    by_log = {log: column for column, log in COLUMNS.items()}
    changes = {
        name: plain.with_(**{name: plain[name] * (1 + 0.2 * deviation)})
        for name, deviation in uncertain.items()
        if plain[name] > 0
    }
    instruments = [instrument_of(case, by_log[name]) for name in CHANNELS]
    seen = [by_log[name] in case.recordings[0] for name in CHANNELS]
    weight = np.where(seen, math.sqrt(2 * STRIDE), 0.0) / np.array([_noise(one) for one in instruments])
    names = (*changes, *OFFSETS)
    information, gain, total = np.zeros((len(names), len(names))), np.zeros(len(names)), 0.0
    for truth in case.truth:
        shown = _shown(case, truth, instruments)
        time = truth.log["time"]
        width = round(WINDOW / float(np.median(np.diff(time))))
        for left in range(0, len(time) - width, 2 * width):
            rows = slice(left, left + width)
            state, command, ticks = truth.states[left], truth.log["command"][rows], truth.ticks[rows]
            base = _predict(plain, state, command, ticks, truth.dt)

            def view(values: Array) -> Array:
                return (values[::STRIDE] * weight).ravel()

            columns = [
                view(_predict(machine, state, command, ticks, truth.dt) - base) / 0.2 for machine in changes.values()
            ]
            for name, deviation in OFFSETS.items():
                unit = np.where(np.array(CHANNELS) == name, deviation, 0.0)
                columns.append(view(np.broadcast_to(unit, base.shape)))
            free = []
            for place, step in _STATE_STEPS:
                moved = state.copy()
                moved[place] += step if place in (XP, VP) else step * state[place]
                if place in (XP, VP):
                    moved[place + XL - XP] = moved[place]
                free.append(view(_predict(plain, moved, command, ticks, truth.dt) - base))
            basis, _ = np.linalg.qr(np.column_stack(free))
            table = np.column_stack([*columns, view(shown[rows] - base)])
            table -= basis @ (basis.T @ table)
            information += table[:, :-1].T @ table[:, :-1]
            gain += table[:, :-1].T @ table[:, -1]
            total += float(table[:, -1] @ table[:, -1])
    return Evidence(names, information, gain, total)


def _shown(case: Case, truth: Truth, instruments: Sequence[Instrument]) -> Array:
    """Return what noiseless instruments show of `CHANNELS`, position in piston coordinates, shape (n, 4)."""
    shown = np.empty((len(truth.log["time"]), len(CHANNELS)))
    for j, (name, one) in enumerate(zip(CHANNELS, instruments)):
        clean = replace(one, noise=0.0, slow_noise=0.0, bits=0)
        key = "line" + name[-2:] if case.at_valve and name.startswith("pressure") else name
        zero = case.bench.zero if name == "position" else 0.0
        shown[:, j] = measure(truth.log["time"], truth.log[key] - zero, clean, np.random.default_rng(0)) + zero
    return shown


def distance(case: Case) -> float:
    """Return how far the case is from the same bench without what is hidden, in standard deviations.

    Args:
        case: Drawn with `keep_states=True`.
    """
    found = evidence(case)
    best = np.linalg.solve(found.information + np.eye(len(found.gain)), found.gain)
    return math.sqrt(max(found.total - float(found.gain @ best), 0.0))


def concealed(case: Case) -> Case:
    """Return the case with the believed numbers tuned until they hide what they can.

    Flow capacity, dead volumes, mass, damping and known effects are fitted to the windows, with eight times the freedom
    that a careful laboratory leaves and at most 40 % away; the owner then believes the fit.

    Args:
        case: Drawn with `keep_states=True`.
    """
    found = evidence(case, TUNED)
    wide = np.array([1.0 if name in OFFSETS else 8.0 for name in found.names])
    best = np.linalg.solve(found.information + np.diag(wide**-2.0), found.gain)
    change = {
        name: 1 + float(np.clip(theta * TUNED[name], -0.4, 0.4))
        for name, theta in zip(found.names, best)
        if name in TUNED
    }
    bench = case.bench
    fields = {"heat_conductance": "wall_heat_transfer", "coulomb": "coulomb_friction", "viscous": "viscous_friction"}
    known = {}
    for (name, where), parameters in bench.known.items():
        factor = next((change[field] for field, effect in fields.items() if effect == name and field in change), 1.0)
        known[name, where] = {key: value * factor for key, value in parameters.items()}
    owner = replace(
        bench,
        valve_area=bench.valve_area * change["valve_area"],
        dead_1=bench.dead_1 * change["dead_1"],
        dead_2=bench.dead_2 * change["dead_2"],
        mass=bench.mass * change["load_mass"],
        damping=bench.damping * change["damping"],
        known=known,
    )
    return replace(case, believed=owner)


def ideal_limit(key: str, seed: int, conditions: Conditions, rounds: int = 4) -> float:
    """Return the size of one effect that the instruments alone would let a perfect method find on this seed's bench.

    Args:
        key: Of `hidden_effects.EFFECTS`.
        seed, conditions: As `make_case` takes them.
        rounds: Steps of the search; each redraws the case at a new size.

    Returns:
        Size, between the effect's `smallest` and 8; at either end it means "beyond".
    """
    chosen = replace(conditions, recordings=1, oddities=False, sensors=replace(conditions.sensors, correlated=0.0))
    bottom, top = float(np.log(find(key).smallest)), math.log(8.0)
    low, high = bottom, top
    place = max(float(np.log(0.003)), bottom)
    tried: list[tuple[float, float]] = []
    for _ in range(rounds):
        apart = distance(make_case(key, [key], seed, float(np.exp(place)), chosen, keep_states=True))
        off = float(np.log(max(apart, 1e-3) / NEEDED))
        tried.append((place, off))
        if abs(off) < 0.1 or (off > 0 and place <= bottom):
            break
        low, high = (place, high) if off < 0 else (low, place)
        slope = 1.0
        if len(tried) > 1:
            (a, off_a), (b, off_b) = tried[-2:]
            slope = (off_b - off_a) / (b - a) if (off_b - off_a) * (b - a) > 0 else 1.0
        wish = place - off / max(slope, 0.25)
        place = wish if low < wish < high else (bottom if wish <= bottom and low == bottom else 0.5 * (low + high))
    best, off = min(tried, key=lambda entry: abs(entry[1]))
    return float(np.exp(np.clip(best - off, bottom, top)))


def limit(key: str) -> float:
    """Return the limit that sizes are counted in: the ideal one and 3.86 healthy imperfections, in quadrature.

    The ideal limit is the median of the reference benches (`limits.json`, written by `python -m exo_sim.trials.detection_limit`).

    Args:
        key: Of `hidden_effects.EFFECTS`.
    """
    return float(np.hypot(reference_limits()[key], NEEDED * find(key).healthy))


def sized(keys: Sequence[str], times: float) -> list[float]:
    """Return the sizes at which each effect stands at `times` its limit, as far as the machine bears it."""
    return [min(times * limit(key), find(key).largest) for key in keys]


@cache
def reference_limits() -> dict[str, float]:
    """Return the ideal limit of every effect, median over the reference benches."""
    return json.loads(_REFERENCE.read_text())["ideal"]


def main(seeds: Sequence[int] = (11, 12, 13)) -> None:
    """Compute `limits.json` afresh."""
    table: dict[str, float] = {}
    for key in each(list(EFFECTS), "limits", total=len(EFFECTS)):
        found = []
        for seed in seeds:
            with suppress(TrialError):
                found.append(ideal_limit(key, seed, Conditions()))
        table[key] = float(f"{np.median(found):.4g}")
    with replacing(_REFERENCE) as path:
        path.write_text(
            json.dumps({"schema": "exo-sim/limits/1", "seeds": list(seeds), "ideal": table}, indent=1) + "\n"
        )


if __name__ == "__main__":
    main()
