"""A whole walking trial as a motion: every stride with the angles and at the time that it was recorded with.

The cycle is the longest run of whole strides without a gap. What rigid segments of other lengths need, so that the foot on the ground rests
there, is taken from the mean stride (`contact_fit`) and added to every stride at its own phase; the rest of what a stride differs by moves
the pelvis. The end of the last stride is led back to where the first begins.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import ScenarioError
from exo_sim.gait import fourier
from exo_sim.gait.contact_fit import HARMONICS
from exo_sim.gait.motion import SAMPLES, Motion, WholeTrial, derivatives, smooth
from exo_sim.gait.recorded_gait import RecordedGait
from exo_sim.gait.strides import Strides
from exo_sim.gait.walking import LEAN, contacts, pressure_centres, shares, walking_as
from exo_sim.gait.walking_trial import Trial
from exo_sim.machine.person import Person, leg_points

Array = NDArray[np.float64]

#: Strides that a trial may have: tables and plans are made for all of them.
MOST_STRIDES = 200
#: The last part of the last stride, in strides, over which the end is led back to the beginning.
_LED_BACK = 0.3
#: Harmonics of a stride that the pelvis may follow beyond the mean stride's path.
_PATH_HARMONICS = 4
#: Ball and heel carry by turns between these phases of stance.
_ROLLED = (0.13, 0.36)


@dataclass(frozen=True)
class Cut:
    """Part of a trial that is whole strides.

    Attributes:
        start, stop: Where it lies [s].
        strides: How many.
        foot_phase: Phase of the left and of the right foot from its own heel strike, counted on, (n, 2); n = SAMPLES for each stride.
        angles: "tilt", and "thigh", "knee", "ankle" of "_l" and "_r", as the mean stride's fit moves them [rad], shape (n,).
        led_back: By how much the end was moved to meet the beginning at most [rad].
        figures: The mean stride.
    """

    start: float
    stop: float
    strides: int
    foot_phase: Array
    angles: dict[str, Array]
    led_back: float
    figures: RecordedGait


def cut(trial: Trial, found: Strides, figures: RecordedGait) -> Cut:
    """Return the longest run of whole strides of a trial, angles on even samples.

    Args:
        trial: Signs and zeros those of the machine.
        found: Its strides.
        figures: The mean of them, moved so that the foot rests.

    Raises:
        ScenarioError: there are more than `MOST_STRIDES`.
    """
    leading, strikes = max(((side, _longest_run(found, side)) for side in "rl"), key=lambda run: len(run[1]))
    count, start, stop = len(strikes) - 1, strikes[0], strikes[-1]
    if count > MOST_STRIDES:
        raise ScenarioError(
            f"{trial.file_name}: {count} strides without a gap; at most {MOST_STRIDES} are walked as they are: choose a part with from and "
            "to in the [gait] table of a scenario file"
        )
    n = count * SAMPLES
    time = start + (stop - start) * np.arange(n) / n
    own = np.interp(time, strikes, np.arange(count + 1.0))
    late = _lateness(found, "l" if leading == "r" else "r", strikes)
    other = own - np.interp(own, np.arange(count) + 0.5, late, period=count)
    phase = np.stack([own, other] if leading == "l" else [other, own], axis=1)
    angles, led_back = {}, 0.0
    tilt = trial.angles.get("tilt", np.zeros(len(trial.time)))
    for name, values in [("tilt", tilt), *((key, trial.angles[key]) for key in trial.angles if key[-2:] in ("_l", "_r"))]:
        good = np.isfinite(values)
        angles[name], moved = _led_back(np.interp(time, trial.time[good], values[good]), count)
        led_back = max(led_back, moved)
    moved_angles = {"tilt": _kept(angles["tilt"], count)}
    for i, side in enumerate("lr"):
        angles[f"thigh_{side}"] = angles["tilt"] + angles[f"hip_{side}"]
        for name in ("thigh", "knee", "ankle"):
            fitted = figures.motion[name](phase[:, i]) - figures.recorded[name](phase[:, i])
            moved_angles[f"{name}_{side}"] = _kept(angles[f"{name}_{side}"] + fitted, count)
    return Cut(start, stop, count, phase, moved_angles, led_back, figures)


def factory(trial: Cut) -> partial[Motion]:
    """Return what makes the motion for a person."""
    return partial(motion, trial)


def motion(trial: Cut, person: Person) -> Motion:
    """Return a trial as a motion whose cycle is all of its strides; phase 0 is its first heel strike."""
    mean = walking_as(trial.figures, person)
    phase, angles, count = trial.foot_phase, trial.angles, trial.strides
    left, right = phase[:, 0] % 1.0, phase[:, 1] % 1.0
    share = shares(left, right, trial.figures.stance_end)
    x, z, advance = _path(trial, share, person)
    pitch = angles["tilt"] - LEAN
    columns = [x, z, pitch]
    for side in "lr":
        columns += [angles[f"thigh_{side}"] - pitch, angles[f"knee_{side}"], angles[f"ankle_{side}"]]
    position = np.stack(columns, axis=1)
    slope, curvature = derivatives(position)
    slope[:, 0] += advance
    return Motion(
        period=trial.stop - trial.start, advance=advance, position=position, slope=slope, curvature=curvature, share=share,
        pressure_centre=pressure_centres(left, right, trial.figures.stance_end, person),
        contact=contacts(left, right, trial.figures.stance_end), support=np.ones(len(position)),
        trial=WholeTrial(count, replace(mean, period=(trial.stop - trial.start) / count), phase),
    )  # fmt: skip


def _path(trial: Cut, share: Array, person: Person) -> tuple[Array, Array, float]:
    """Return where the pelvis is so that what stands rests: ahead without the steady advance, up [m], and the advance of the cycle."""
    n, count = len(share), trial.strides
    height, ahead = np.zeros(n), np.zeros(n)
    for i, side in enumerate("lr"):
        thigh, knee, ankle = (trial.angles[f"{name}_{side}"] for name in ("thigh", "knee", "ankle"))
        point = leg_points(thigh, knee, ankle, person)
        on_ball = smooth((trial.foot_phase[:, i] % 1.0 - _ROLLED[0]) / (_ROLLED[1] - _ROLLED[0]))
        on_ball = np.where(trial.foot_phase[:, i] % 1.0 > trial.figures.stance_end, 0.5, on_ball)
        rate = {name: derivatives(point[name])[0][:, 0] for name in ("heel", "toe")}
        height -= share[:, i] * ((1 - on_ball) * point["heel"][:, 1] + on_ball * point["toe"][:, 1])
        ahead -= share[:, i] * ((1 - on_ball) * rate["heel"] + on_ball * rate["toe"])
    advance = float(ahead.mean())
    right = trial.foot_phase[:, 1]
    usual_z = trial.figures.motion["pelvis_z"](right) * person.scale
    usual_x = trial.figures.motion["pelvis_x"](right) * person.scale
    z = usual_z + _kept(height - usual_z, count, _PATH_HARMONICS)
    more = fourier.fit(ahead - advance - derivatives(usual_x)[0], _PATH_HARMONICS * count).integral()
    return usual_x + more(np.arange(n) / n), z, advance


def _longest_run(found: Strides, side: str) -> list[float]:
    """Return the heel strikes of the longest run of strides of a foot that follow each other [s]."""
    runs: list[list[float]] = [[]]
    for begin, end in sorted((a, b) for s, a, b in found.spans if s == side):
        if runs[-1] and abs(runs[-1][-1] - begin) < 1e-6:
            runs[-1].append(end)
        else:
            runs.append([begin, end])
    return max(runs, key=len)


def _lateness(found: Strides, side: str, strikes: list[float]) -> Array:
    """Return by what share of a stride the other foot strikes later, of each stride; a half where it was not seen."""
    own = [a for s, a, _ in found.spans if s == side] + [b for s, _, b in found.spans if s == side]
    out = []
    for begin, end in itertools.pairwise(strikes):
        inside = [(t - begin) / (end - begin) for t in own if begin < t < end]
        near = [share for share in inside if 0.3 < share < 0.7]
        out.append(near[0] if near else np.nan)
    late = np.array(out)
    late[~np.isfinite(late)] = np.nanmean(late) if np.isfinite(late).any() else 0.5
    return late


def _led_back(values: Array, count: int) -> tuple[Array, float]:
    """Return values whose last part leads back to the first one, and by how much the end was moved."""
    apart = float(values[-1] - values[0])
    at = np.arange(len(values)) / SAMPLES  # in strides
    return values - apart * smooth((at - (count - _LED_BACK)) / _LED_BACK), abs(apart)


def _kept(values: Array, count: int, harmonics: int = HARMONICS) -> Array:
    """Return values without what is faster than some harmonics of a stride."""
    spectrum = np.fft.rfft(values)
    spectrum[harmonics * count + 1 :] = 0.0
    return np.fft.irfft(spectrum, len(values))
