"""Whether it takes more to start a motion than to keep it up: then its onsets are rows of the balance as well."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear

from exo_sim.diagnosis.estimation.correlation import correlation_time
from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.policy.acceptance import SURELY_MORE
from exo_sim.diagnosis.policy.recordings import FEWEST_ONSETS, FEWEST_ROWS
from exo_sim.diagnosis.subsystems.motion.model import MotionModel
from exo_sim.diagnosis.subsystems.motion.onsets import Starting
from exo_sim.recording.noise import robust_deviation

#: Standard error of a median in units of that of a mean, sqrt(pi/2), of normal errors.
MEDIAN_ERROR = math.sqrt(0.5 * math.pi)


@dataclass(frozen=True)
class SlidingLine:
    """Friction of a contact that slides, as a line over speed.

    Attributes:
        level: At speed 0, where friction acts [N or N m], with its standard error ...
        error: ... [N or N m].
        damping: Slope [N s/m or N m s/rad], not below 0.
        constant: Force that is the same in both directions, along +v [N or N m]; 0 where the motion does not tell it from the level.
    """

    level: float
    error: float
    damping: float
    constant: float


def sliding_line(model: MotionModel) -> SlidingLine:
    """Return the line of a model's rows, each weighed by the standard deviation of its force where friction acts."""
    friction, direction, weight = model.friction_of_rows(), np.sign(model.velocity), model.lever / model.scale
    columns = [np.ones(model.size), model.speed]
    if min(np.count_nonzero(direction > 0.0), np.count_nonzero(direction < 0.0)) >= healthy.FEWEST_FOR_FUNCTIONS:
        columns.append(direction)
    weighted = weight[:, None] * np.column_stack(columns)
    found = lsq_linear(weighted, weight * friction, ([-np.inf, 0.0, -np.inf][: len(columns)], np.inf), method="bvls").x
    left = weighted @ found - weight * friction
    variance = max(float(left @ left) / model.size, 1.0) * correlation_time(left, model.blocks)
    error = math.sqrt(variance * float(np.linalg.pinv(weighted.T @ weighted)[0, 0]))
    return SlidingLine(float(found[0]), error, float(found[1]), float(found[2]) if len(columns) > 2 else 0.0)


def with_breakaway(model: MotionModel) -> MotionModel:
    """Return the model with its onsets where friction there exceeds the line of sliding friction, and not only by chance.

    It must be exceeded surely, by the scatter of the onsets and the error of the line together, and by more than laws of speed get wrong of
    a healthy machine. Onsets that lie below it tell nothing: a contact that has crept before it breaks loose seems weaker than it is.
    """
    if model.size < FEWEST_ROWS:
        return model
    line = sliding_line(model)
    if line.level <= 0.0:  # no dry friction
        return model
    every = model.with_onsets(Starting(line.damping))
    peaks = every.onset_peaks(line.constant)
    if peaks.size < FEWEST_ONSETS:
        return model
    starting = Starting(line.damping, 0.0, float(np.median(peaks)) - healthy.CREPT * robust_deviation(peaks), line.constant)
    every = model.with_onsets(starting)
    excess = (every.friction_of_rows() - line.level - line.constant * np.sign(every.velocity))[model.size :]
    if excess.size < FEWEST_ONSETS:
        return model
    scatter = robust_deviation(excess)
    by_chance = SURELY_MORE * math.hypot(MEDIAN_ERROR * scatter / math.sqrt(excess.size), line.error)
    beyond = max(by_chance, healthy.ONSET_EXCESS * healthy.FRICTION_SPEED * line.level)
    return model.with_onsets(replace(starting, scatter=scatter)) if float(np.median(excess)) > beyond else model
