"""A sensor, filter or second acquisition card that is late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.declaration import Effect, Parameter

EFFECT = Effect(
    name="sensor_delay",
    places=("column",),
    family="sensor",
    question="Is every event of one channel late by the same time, even of a sealed piston?",
    says="The channel is late.",
    parameters=(Parameter("seconds", "s", -10.0, 10.0, (5e-4, 2e-2), "sensor lag 0.5-5 ms, cards 1-20 ms, slow loggers to 1 s"),),
    cut="sensor",
    reveals=(),
    mistaken_for=("valve_lag", "wall_heat_transfer"),
    experiment="move a sealed piston by hand: its pressure must lead",
    convention="+ is late: the sensor shows the truth of that many seconds before.",
    valid="every frequency is late by the same time; a filter is that only well below its corner.",
    signature="the same delay in all events of one channel",
)


def read(values: NDArray[np.float64], time: NDArray[np.float64], seconds: float) -> NDArray[np.float64]:
    """Return what the sensor shows of the true `values` (n,) at `time` (n,): those of `seconds` before."""
    return np.interp(time - seconds, time, values)


def truth(values: NDArray[np.float64], time: NDArray[np.float64], seconds: float) -> NDArray[np.float64]:
    """Return what the sensor saw where it shows `values` (n,) at `time` (n,): those of `seconds` after; a missing one stays missing."""
    good = np.isfinite(values)
    if not good.any():
        return values
    return np.where(good, np.interp(time + seconds, time[good], values[good]), np.nan)
