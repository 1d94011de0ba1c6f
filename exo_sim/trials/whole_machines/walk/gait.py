"""How somebody moves: strides, squats and standing, as angles of hips and knees.

The stride is the mean of 2.5 s of subject01 of the OpenSim model Gait10dof18musc (CC BY 3.0), four harmonics; the left leg is half a
stride behind. Angles are in radian, flexion of the hip and extension of the knee positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Mean, cosines and sines of the first four harmonics of the stride [rad].
STRIDE = {
    "hip": (-0.0019, (-0.3964, -0.1169, 0.0244, -0.0104), (0.0235, -0.0310, -0.0450, -0.0035)),
    "knee": (-0.4035, (0.0219, 0.3713, -0.0528, 0.0338), (-0.3723, -0.1100, 0.1184, -0.0186)),
}
STANDING = {"hip": 0.05, "knee": -0.10}
SQUATTING = {"hip": 0.32, "knee": -1.05}
#: Strides a second; 0 stands, and "squats" goes down and up.
PACES = {"stand": 0.0, "slow": 0.62, "walk": 0.81, "fast": 1.05, "squats": 0.35}
JOINTS = tuple(f"{joint}_{side}" for side in ("r", "l") for joint in ("hip", "knee"))
#: The widest angles that any gait here reaches [rad].
RANGE = {"hip": (-0.66, 0.50), "knee": (-1.48, 0.16)}
_CHANGE = 0.35


def gait(names: tuple[str, ...], time: Array, rng: np.random.Generator) -> tuple[dict[str, Array], NDArray[np.bool_]]:
    """Return the angle of each of `JOINTS`, shape (n,), and whether somebody stands still.

    Args:
        names: Of `PACES`, one after another.
        time: [s], shape (n,), evenly spaced within a few percent.
        rng: Chance: lengths of the parts, the cadence and the strength of each stride.
    """
    shares = rng.uniform(0.8, 1.2, len(names))
    edges = np.concatenate([[0.0], np.cumsum(shares / shares.sum())]) * (time[-1] + 1e-9)
    part = np.clip(np.searchsorted(edges, time, side="right") - 1, 0, len(names) - 1)
    kind = np.array(names)[part]
    pace = np.array([PACES[name] for name in names])[part] * rng.uniform(0.93, 1.07)
    beats = np.arange(-2.0, time[-1] + 2.0, 0.9)
    pace = pace * (1.0 + np.interp(time, beats, rng.normal(0, 0.03, len(beats))))
    step = float(np.median(np.diff(time)))
    phase = 2 * np.pi * np.cumsum(_soft(pace, step)) * step
    walking, squatting = (_soft(np.isin(kind, list_).astype(float), step) for list_ in (("slow", "walk", "fast"), ("squats",)))
    size = 1.0 + np.interp(time, beats, rng.normal(0, 0.04, len(beats)))
    angles = {}
    for name in JOINTS:
        joint, _, side = name.partition("_")
        mean, cosines, sines = STRIDE[joint]
        late = phase + (np.pi if side == "l" else 0.0)
        wave = sum(c * np.cos(k * late) + s * np.sin(k * late) for k, (c, s) in enumerate(zip(cosines, sines), 1))
        down = 0.5 * (1.0 - np.cos(phase)) * (SQUATTING[joint] - STANDING[joint])
        sway = 0.012 * np.sin(2 * np.pi * rng.uniform(0.1, 0.3) * time + rng.uniform(0, 6))
        angles[name] = STANDING[joint] + walking * (mean - STANDING[joint] + size * wave) + squatting * down + sway
    return angles, (walking < 0.02) & (squatting < 0.02) & (kind == "stand")


def _soft(values: Array, step: float) -> Array:
    """Return values that change over a raised cosine instead of at once."""
    count = max(3, round(2 * _CHANGE / step))
    window = np.hanning(count + 2)[1:-1]
    padded = np.concatenate([np.full(count, values[0]), values, np.full(count, values[-1])])
    soft: Array = np.convolve(padded, window / window.sum(), mode="same")[count:-count]
    return soft
