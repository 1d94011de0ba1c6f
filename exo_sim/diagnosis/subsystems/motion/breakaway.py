"""Whether it takes more to start a motion than to keep it up: then its onsets are rows of the balance as well."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.policy.recordings import FEWEST_ONSETS, FEWEST_ROWS
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.onsets import Starting
from exo_sim.recording.noise import robust_deviation


def with_breakaway(model: MotionModel) -> MotionModel:
    """Return the model with its onsets where friction there exceeds the line of sliding friction, and not only by chance.

    The line is fitted to the rows of the motion: a level, a slope over speed, and a constant force either way. It must be exceeded by more
    than the standard error, and by more than laws of speed get wrong of a healthy machine. Onsets that lie below it tell nothing: a
    contact that has crept before it breaks loose seems weaker than it is.
    """
    if model.size < FEWEST_ROWS:
        return model
    way = np.sign(model.velocity)
    line = np.column_stack([np.ones(model.size), model.speed, way])
    level, damping, constant = np.linalg.lstsq(line, model.friction_of_rows(), rcond=None)[0].tolist()
    if level <= 0.0:  # no dry friction
        return model
    every = model.with_onsets(Starting(damping))
    peaks = every.onset_peaks(constant)
    if peaks.size < FEWEST_ONSETS:
        return model
    starting = Starting(damping, 0.0, float(np.median(peaks)) - healthy.CREPT * robust_deviation(peaks), constant)
    every = model.with_onsets(starting)
    excess = (every.friction_of_rows() - level - constant * np.sign(every.velocity))[model.size :]
    scatter = robust_deviation(excess)
    by_chance = max(scatter / math.sqrt(excess.size), healthy.ONSET_EXCESS * healthy.FRICTION_SPEED * level)
    return model.with_onsets(replace(starting, scatter=scatter)) if float(np.median(excess)) > by_chance else model
