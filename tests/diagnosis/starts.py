"""A mass that is pushed to and fro, with a rest before every stroke: dry friction rises to its level there, and may fall behind it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from diagnosis import motion_runs
from numpy.typing import NDArray

from exo_sim.diagnosis.data.motion_run import Inertia, Kinematics, MotionRun
from exo_sim.recording.filters import gaussian_smoothed

Array = NDArray[np.float64]

TIME = np.arange(12000, dtype=float) * 1e-3
#: Each stroke takes so long, a rest of `REST` and a motion [s].
STROKE, REST = 0.8, 0.3
FASTEST, LEVEL, DAMPING, DIP = 0.25, 15.0, 40.0, 0.02
_PHASE = TIME % STROKE
_WAY = np.where((TIME // STROKE) % 2 < 1, 1.0, -1.0)
VELOCITY = _WAY * FASTEST * np.where(_PHASE > REST, np.sin(np.pi * (_PHASE - REST) / (STROKE - REST)) ** 2, 0.0)
POSITION = np.cumsum(VELOCITY) * 1e-3
#: First sample of each motion.
BEGINS = np.flatnonzero(np.diff(np.abs(VELOCITY) > 0.0, prepend=False) & (VELOCITY != 0.0))


def run(excess: float = 0.0, noise: float = 0.05) -> MotionRun:
    """Return the balance; `excess` is what it takes more to start than to slide [N]. All of it behind the filter of the balance."""
    moving = np.sign(VELOCITY) * (LEVEL + excess * np.exp(-np.abs(VELOCITY) / DIP)) + DAMPING * VELOCITY
    held = _WAY * (LEVEL + excess) * (2.0 * _PHASE / REST - 1.0)  # from what the last stroke left to what starts this one
    lost = np.where(_PHASE > REST, moving, held) + noise * np.random.default_rng(4).standard_normal(TIME.size)
    plain = motion_runs.balance(np.zeros(motion_runs.TIME.size), noise)
    nothing, acceleration = np.zeros(TIME.size), np.gradient(VELOCITY, TIME)
    inertia, lost = (gaussian_smoothed(TIME, one, 0.031) for one in (motion_runs.MASS * acceleration, lost))
    drive = replace(plain.drive, force=nothing, arm=np.ones(TIME.size), gauge=np.zeros((TIME.size, 2)))
    return replace(
        plain, time=TIME, kinematics=Kinematics(POSITION, gaussian_smoothed(TIME, VELOCITY, 0.031), still=5e-3, velocity_noise=1e-3),
        inertia=Inertia(inertia, nothing, nothing, motion_runs.MASS), passive=replace(plain.passive, force=nothing), drive=drive,
        external=inertia + lost,
    )  # fmt: skip
