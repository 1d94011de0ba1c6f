"""The strides of a trial: where they begin and end, and their mean over the phase.

A stride lasts from heel strike to heel strike of one foot. Where the ground's force was recorded under a foot, it begins where the force
rises through 20 N; else where the heel is farthest ahead of the hip, and the foot leaves the ground where the ball of the foot is farthest
behind (Zeni, Richards and Higginson 2008, Gait & Posture 27:710-714).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ScenarioError
from exo_sim.gait.contact_fit import PHASES
from exo_sim.gait.walking_trial import GroundForce, Trial
from exo_sim.machine.person import Person, leg_points

Array = NDArray[np.float64]

#: Force from which a foot stands [N].
CONTACT_FORCE = 20.0
#: Strides are between these long [s].
SHORTEST, LONGEST = 0.5, 3.5
#: A stride's length may differ from the usual one by this share.
_ODD = 0.25
#: Stance ends between these phases of the stride.
_STANCE = (0.52, 0.75)
#: A plate's contact belongs to the foot whose heel strikes within this time of it [s].
_NEAR = 0.15


@dataclass(frozen=True)
class Strides:
    """What a trial's strides have in common.

    Attributes:
        spans: Foot, beginning and end of each stride [s].
        period: Mean length [s].
        stance_end: Phase at which the foot leaves the ground, mean.
        angles: "tilt", "thigh", "knee", "ankle" of every stride of both legs over the phase from its own heel strike, (strides, PHASES).
        path: Mean way of the pelvis over a stride [m], shape (PHASES,), or None where it was not recorded.
        by_force: Whether strides were found by the ground's force.
    """

    spans: tuple[tuple[str, float, float], ...]
    period: float
    stance_end: float
    angles: dict[str, Array]
    path: Array | None
    by_force: bool


def find(trial: Trial, ground: GroundForce | None = None) -> Strides:
    """Return the strides of a trial.

    Raises:
        ScenarioError: there is no whole stride in it.
    """
    strikes, lifts = events(trial)
    by_force = False
    if ground is not None:
        measured = _by_force(ground, strikes, lifts, trial)
        if measured is not None:
            strikes, lifts, by_force = *measured, True
    for side in "lr":
        if len(trial.contacts.get(side, ())) > 1:
            strikes[side] = list(trial.contacts[side])
            lifts[side] = list(trial.leaves.get(side, lifts[side]))
    spans = [(side, a, b) for side in "lr" for a, b in itertools.pairwise(strikes[side]) if SHORTEST < b - a < LONGEST]
    spans = [span for span in spans if trial.time[0] - 1e-9 <= span[1] and span[2] <= trial.time[-1] + 1e-9 and _whole(trial, *span)]
    if not spans:
        long = trial.time[-1] - trial.time[0]
        raise ScenarioError(
            f"{trial.file_name}: no whole stride in {long:.2f} s of it: record one or more from heel strike to heel strike of a foot "
            "without gaps, or name the columns in a [gait] table if they are not those of a walk"
        )
    usual = float(np.median([b - a for _, a, b in spans]))
    spans = [span for span in spans if abs(span[2] - span[1] - usual) < _ODD * usual]
    ends = [(min(off) - a) / (b - a) for side, a, b in spans if (off := [t for t in lifts[side] if a + 0.4 * (b - a) < t < b])]
    stance_end = float(np.clip(np.mean(ends) if ends else 0.62, *_STANCE))
    angles: dict[str, list[Array]] = {name: [] for name in ("tilt", "thigh", "knee", "ankle")}
    paths = []
    tilt = trial.angles.get("tilt", np.zeros(len(trial.time)))
    for side, a, b in spans:
        at = a + (b - a) * np.arange(PHASES) / PHASES
        one = {name: _at(trial.time, trial.angles[f"{name}_{side}"], at) for name in ("hip", "knee", "ankle")}
        one["tilt"] = _at(trial.time, tilt, at)
        for name in ("tilt", "knee", "ankle"):
            angles[name].append(one[name])
        angles["thigh"].append(one["tilt"] + one["hip"])
        if "pelvis_x" in trial.angles:
            paths.append(_at(trial.time, trial.angles["pelvis_x"], at))
    return Strides(
        tuple(spans), float(np.mean([b - a for _, a, b in spans])), stance_end, {name: np.array(v) for name, v in angles.items()},
        np.mean(paths, axis=0) if paths else None, by_force,
    )  # fmt: skip


def events(trial: Trial) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """Return heel strikes and toe-offs of each foot by where the foot is before the hip [s]."""
    strikes, lifts = {}, {}
    tilt = trial.angles.get("tilt", np.zeros(len(trial.time)))
    for side in "lr":
        hip, knee, ankle = (_filled(trial.time, trial.angles[f"{name}_{side}"]) for name in ("hip", "knee", "ankle"))
        point = leg_points(_filled(trial.time, tilt) + hip, knee, ankle, Person())
        strikes[side] = _peaks(trial.time, point["heel"][:, 0])
        lifts[side] = _peaks(trial.time, -point["toe"][:, 0])
    return strikes, lifts


def _peaks(time: Array, values: Array) -> list[float]:
    """Return when values are greatest, once a stride."""
    from scipy.signal import find_peaks  # the gait that comes along has its strides

    even = np.arange(time[0], time[-1], 0.005)
    if len(even) < 3:
        return []
    signal = np.interp(even, time, values)
    apart = max(1, round(0.7 * _stride_time(signal) / 0.005))
    found, _ = find_peaks(signal, distance=apart, prominence=0.4 * np.ptp(signal))
    return [float(even[i]) for i in found]


def _stride_time(signal: Array) -> float:
    """Return the period of a signal at 200 Hz by its autocorrelation [s], `SHORTEST` at the least."""
    from scipy.signal import find_peaks

    centred = signal - signal.mean()
    n = len(centred)
    first, last = round(SHORTEST / 0.005), min(round(LONGEST / 0.005), n - 20)
    if last <= first:
        return SHORTEST
    lags = np.arange(first, last)
    pairs = ((centred[lag:], centred[:-lag]) for lag in lags)
    alike = np.array([later @ earlier / (np.linalg.norm(later) * np.linalg.norm(earlier) + 1e-12) for later, earlier in pairs])
    tops, _ = find_peaks(alike, height=0.5 * max(float(alike.max()), 0.0))
    return 0.005 * float(lags[tops[0]] if len(tops) else lags[int(np.argmax(alike))])


def _by_force(
    ground: GroundForce, strikes: dict[str, list[float]], lifts: dict[str, list[float]], trial: Trial
) -> tuple[dict[str, list[float]], dict[str, list[float]]] | None:
    """Return heel strikes and toe-offs by the plates, or None where they tell of no whole stride.

    Raises:
        ScenarioError: forces and angles have no time in common.
    """
    if ground.time[0] > trial.time[-1] or ground.time[-1] < trial.time[0]:
        raise ScenarioError(
            f"{ground.file_name}: lasts from {ground.time[0]:.2f} to {ground.time[-1]:.2f} s, the angles in {trial.file_name} from "
            f"{trial.time[0]:.2f} to {trial.time[-1]:.2f} s; hand in forces of the same trial on the same clock"
        )
    on: dict[str, list[float]] = {"l": [], "r": []}
    off: dict[str, list[float]] = {"l": [], "r": []}
    for label, force in ground.up.items():
        begins, ends = _contacts(ground.time, force)
        side = ground.foot.get(label) or _whose(begins, strikes)
        if side is None:
            continue
        on[side] += begins
        off[side] += ends
    if max(len(on["l"]), len(on["r"])) < 2:
        return None
    for side in "lr":
        if len(on[side]) < 2:  # one foot on no plate: its strides are those that the angles tell
            on[side], off[side] = strikes[side], lifts[side]
    return {side: sorted(t) for side, t in on.items()}, {side: sorted(t) for side, t in off.items()}


def _contacts(time: Array, force: Array) -> tuple[list[float], list[float]]:
    """Return when a force rises and falls through `CONTACT_FORCE`, flights and contacts of less than 0.1 s left out [s]."""
    loaded = np.nan_to_num(force) > CONTACT_FORCE
    edges = np.flatnonzero(loaded[1:] != loaded[:-1]) + 1
    kept: list[int] = []
    for edge in edges:
        if kept and time[edge] - time[kept[-1]] < 0.1:
            kept.pop()
        else:
            kept.append(int(edge))
    begins = [float(time[i]) for i in kept if loaded[i]]
    if loaded[0] and force[0] < 3 * CONTACT_FORCE:  # the trial begins on a heel strike
        begins.insert(0, float(time[0]))
    return begins, [float(time[i]) for i in kept if not loaded[i]]


def _whose(begins: Sequence[float], strikes: dict[str, list[float]]) -> str | None:
    """Return the foot whose heel strikes coincide with a plate's contacts, or None where neither foot's do."""
    votes = {side: sum(any(abs(t - s) < _NEAR for s in strikes[side]) for t in begins) for side in "lr"}
    return None if votes["l"] == votes["r"] else max(votes, key=lambda side: votes[side])


def _at(time: Array, values: Array, at: Array) -> Array:
    good = np.isfinite(values)
    return np.interp(at, time[good], values[good])


def _filled(time: Array, values: Array) -> Array:
    return _at(time, values, time) if np.isfinite(values).sum() > 1 else np.zeros(len(time))


def _whole(trial: Trial, side: str, a: float, b: float) -> bool:
    """Return whether the angles of a leg have no gap of more than a tenth of the stride."""
    for name in ("hip", "knee", "ankle"):
        good = trial.time[np.isfinite(trial.angles[f"{name}_{side}"])]
        inside = np.concatenate([[a], good[(good > a) & (good < b)], [b]])
        if np.diff(inside).max() > 0.1 * (b - a):
            return False
    return True
