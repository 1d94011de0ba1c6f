"""A trial of several strides with the recorded mean gait in both legs."""

from __future__ import annotations

import numpy as np

from exo_sim.gait import recorded_gait
from exo_sim.gait.walking_trial import Trial

PERIOD = 1.1


def walked(strides: int = 4) -> Trial:
    """Return a trial in which the right foot strikes at whole periods [s] and the left foot half a stride later."""
    gait, time, angles = recorded_gait.load("falisse"), np.arange(0.0, strides * PERIOD, 0.01), {}
    for side, shift in (("r", 0.0), ("l", 0.5)):
        phase = time / PERIOD + shift
        tilt = gait.recorded["tilt"](phase)
        angles[f"hip_{side}"] = gait.recorded["thigh"](phase) - tilt
        angles[f"knee_{side}"] = gait.recorded["knee"](phase)
        angles[f"ankle_{side}"] = gait.recorded["ankle"](phase)
    angles["tilt"] = gait.recorded["tilt"](time / PERIOD)
    return Trial("walked", "walked.csv", time, angles)
