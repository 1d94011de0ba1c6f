"""A recorded stride moved as little as possible, so that the stance foot of a rigid chain rests on the ground.

Joint angles that were measured on a person never fit a rigid chain of other lengths exactly: the foot on the ground would slide and sink.
The fit moves the Fourier series of thigh, knee and ankle within the spread between strides until it does not, and finds the height of the
pelvis and the stride length that belong to them. Where the path of the pelvis was recorded it sways ahead and back as it did: two thirds
of the body's mass go with it, and 1 mm of its second harmonic is 1 % of the body weight in the ground's force. Departures of the angles
count the more the faster they are: a foot that rests to the millimetre must not be bought with accelerations that nobody recorded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.gait import fourier
from exo_sim.machine.person import Person, leg_points

HARMONICS = 8
PATH_HARMONICS = (2, 4)  # of the stride: left and right steps are alike, so only even ones
PHASES = 100
ANGLES = ("thigh", "knee", "ankle")
#: Spreads below this count as this [rad].
LEAST_SPREAD = np.radians(0.8)
#: Weight of a departure's acceleration: of an amplitude [rad] by the square of its harmonic. With 0 the thigh of Falisse's stride departed
#: by 7 rad/s^2 at the eighth harmonic, where 1.2 were recorded; with 30 a toe slides 8 mm and is 7 mm high.
_QUIET = 15.0

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fitted:
    """A stride whose stance foot rests.

    Attributes:
        series: "thigh", "knee", "ankle", "pelvis_x" (what is left of a steady advance), "pelvis_z" over the phase from heel strike.
        stride: Stride length [m].
        foot_offset: Added to the recorded ankle angles so that the sole of a rigid foot lies flat [rad].
        moved: By how much each angle was moved at most [rad], and in spreads.
        rest: How far heel and toe move up and down and slide while they are on the ground [m], the lowest point of the foot, and how far
            the swinging foot stays above the ground at the least: "heel_height", "toe_height", "heel_slide", "toe_slide", "lowest",
            "clearance".
    """

    series: dict[str, fourier.Series]
    stride: float
    foot_offset: float
    moved: dict[str, tuple[float, float]]
    rest: dict[str, float]


def _window(phase: Array, start: float, stop: float, edge: float = 0.02) -> Array:
    """Return 1 inside, 0 outside, with edges of length `edge`."""
    return np.clip((phase - start) / edge, 0, 1) * np.clip((stop - phase) / edge, 0, 1)


def _basis(phase: Array, harmonics: tuple[int, ...] | range) -> Array:
    """Return columns cos, sin of each harmonic, shape (n, 2 len(harmonics))."""
    return np.concatenate([[np.cos(2 * np.pi * h * phase), np.sin(2 * np.pi * h * phase)] for h in harmonics]).T


def fit(
    mean: dict[str, fourier.Series], spread: dict[str, Array], sway: Array | None, stance_end: float, person: Person,
    least_spread: float = LEAST_SPREAD,
) -> Fitted:  # fmt: skip
    """Move the angles as little as possible so that the stance foot stays where it is; see the module's docstring.

    Args:
        mean: "thigh", "knee", "ankle" over the phase from heel strike [rad].
        spread: Of the same between strides, shape (PHASES,) [rad].
        sway: `sway_of` the recorded path of the pelvis; None where it was not recorded.
        stance_end: Phase at which the foot leaves the ground.
        person: Whose segments.
        least_spread: Spreads below this count as this [rad].
    """
    from scipy.optimize import least_squares  # the gait that comes along was fitted

    phase = np.arange(2 * PHASES) / (2 * PHASES)
    joint_basis = np.concatenate([np.ones((len(phase), 1)), _basis(phase, range(1, HARMONICS + 1))], axis=1)
    path_basis = _basis(phase, PATH_HARMONICS)
    n_joint, n_path = joint_basis.shape[1], path_basis.shape[1]
    target = {name: mean[name](phase) for name in ANGLES}
    width = {
        name: np.maximum(np.interp(phase, np.arange(PHASES) / PHASES, spread[name], period=1.0), least_spread)
        for name in ANGLES
    }

    def swayed(rest: Array) -> Array:
        return rest[1 + n_path : 1 + 2 * n_path] if sway is None else sway

    def unpack(p: Array) -> tuple[Any, ...]:
        angle = {name: joint_basis @ p[i * n_joint : (i + 1) * n_joint] for i, name in enumerate(ANGLES)}
        rest = p[3 * n_joint :]
        height, drift = rest[0] + path_basis @ rest[1 : 1 + n_path], path_basis @ swayed(rest)
        stride, foot_offset, anchor = rest[-3:]
        return angle, height, drift, stride, foot_offset, anchor

    heel_window, toe_window = _window(phase, 0.0, 0.36), _window(phase, 0.13, stance_end)
    clear = _window(phase, stance_end + 0.06, 0.95, 0.04)

    def residual(p: Array) -> Array:
        angle, height, drift, stride, foot_offset, anchor = unpack(p)
        point = leg_points(angle["thigh"], angle["knee"], angle["ankle"], person)
        x = stride * phase + drift
        heel, toe = point["heel"], point["toe"]
        foot = person.toe - person.heel
        parts = [
            (angle[name] - target[name] - (foot_offset if name == "ankle" else 0.0)) / width[name] for name in ANGLES
        ]
        parts += [20.0 * np.maximum(np.abs(part) - 1.6, 0.0) for part in parts[:3]]
        parts += [heel_window * (heel[:, 1] + height) / 1e-3, toe_window * (toe[:, 1] + height) / 1e-3]
        parts += [
            heel_window * (heel[:, 0] + x - anchor) / 1.8e-3,
            toe_window * (toe[:, 0] + x - anchor - foot) / 1.8e-3,
        ]
        lowest = np.minimum(heel[:, 1], toe[:, 1]) + height
        parts += [clear * np.minimum(lowest - 0.015, 0.0) / 1e-3]
        parts += [(1 - heel_window) * np.minimum(heel[:, 1] + height, 0.0) / 1e-3]
        parts += [(1 - toe_window) * np.minimum(toe[:, 1] + height, 0.0) / 1e-3]
        parts += [
            0.02 * p[i * n_joint + 1 : (i + 1) * n_joint] * np.repeat(np.arange(1, HARMONICS + 1), 2) for i in range(3)
        ]
        departs = (p - start)[: 3 * n_joint].reshape(3, n_joint)[:, 1:]
        parts += [(_QUIET * departs * np.repeat(np.arange(1, HARMONICS + 1), 2) ** 2).ravel()]
        parts += [np.array([foot_offset / np.radians(3.0)])]
        return np.concatenate(parts)

    start = np.zeros(3 * n_joint + 1 + n_path * (2 if sway is None else 1) + 3)
    for i, name in enumerate(ANGLES):
        start[i * n_joint : (i + 1) * n_joint] = np.linalg.lstsq(joint_basis, target[name], rcond=None)[0]
    start[3 * n_joint] = 0.95 * (person.thigh + person.shank + person.ankle_height)
    start[-3] = 1.3
    found = least_squares(residual, start, method="trf", x_scale="jac", max_nfev=200)
    angle, height, drift, stride, foot_offset, _ = unpack(found.x)
    point = leg_points(angle["thigh"], angle["knee"], angle["ankle"], person)
    x = stride * phase + drift
    lowest = np.minimum(point["heel"][:, 1], point["toe"][:, 1]) + height
    inner_heel, inner_toe = _window(phase, 0.02, 0.34, 1e-9) > 0, _window(phase, 0.15, stance_end - 0.02, 1e-9) > 0
    height_of = {name: point[name][:, 1] + height for name in ("heel", "toe")}
    along = {name: point[name][:, 0] + x for name in ("heel", "toe")}
    rest = {f"{name}_height": float(np.ptp(height_of[name][on])) for name, on in (("heel", inner_heel), ("toe", inner_toe))}
    rest |= {f"{name}_slide": float(np.ptp(along[name][on])) for name, on in (("heel", inner_heel), ("toe", inner_toe))}
    rest |= {"lowest": float(lowest.min()), "clearance": float(lowest[clear > 0.9].min())}
    error = {name: np.abs(angle[name] - target[name] - (foot_offset if name == "ankle" else 0.0)) for name in ANGLES}
    moved = {name: (float(error[name].max()), float((error[name] / width[name]).max())) for name in ANGLES}
    series = {
        name: fourier.Series(p[0], p[1::2], p[2::2])
        for i, name in enumerate(ANGLES)
        for p in [found.x[i * n_joint : (i + 1) * n_joint]]
    }
    of_path = found.x[3 * n_joint :]
    series["pelvis_z"] = _path(float(of_path[0]), of_path[1 : 1 + n_path])
    series["pelvis_x"] = _path(0.0, swayed(of_path))
    return Fitted(series, float(stride), float(foot_offset), moved, rest)


def _path(mean: float, p: Array) -> fourier.Series:
    cosine, sine = np.zeros(max(PATH_HARMONICS)), np.zeros(max(PATH_HARMONICS))
    for i, h in enumerate(PATH_HARMONICS):
        cosine[h - 1], sine[h - 1] = p[2 * i], p[2 * i + 1]
    return fourier.Series(mean, cosine, sine)


def sway_of(path: Array) -> Array:
    """Return cosine and sine of the recorded pelvis path about its steady advance, for each of PATH_HARMONICS, metres, shape (4,).

    The advance is taken out through differences, which are periodic; their series is integrated.
    """
    rate = np.diff(path, append=2 * path[-1] - path[-2]) * PHASES
    series = fourier.fit(rate, max(PATH_HARMONICS)).integral()
    half_step = 0.5 / PHASES  # a difference stands for the middle of its interval
    out: list[float] = []
    for h in PATH_HARMONICS:
        c, s, turn = series.cosine[h - 1], series.sine[h - 1], 2 * np.pi * h * half_step
        out += [c * np.cos(turn) - s * np.sin(turn), s * np.cos(turn) + c * np.sin(turn)]
    return np.array(out)
