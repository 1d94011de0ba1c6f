"""A sensor whose gain is off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.declaration import Effect, Parameter

EFFECT = Effect(
    name="sensor_scale",
    places=("column",),
    family="sensor",
    question="Is one channel off in proportion to what it reads?",
    says="The sensor's gain is off.",
    parameters=(
        Parameter(
            "factor",
            "1",
            0.01,
            100.0,
            (0.95, 1.05),
            "0.25-1 % of full scale; worse where a range was mixed up",
            default=1.0,
        ),
    ),
    cut="sensor",
    reveals=(),
    mistaken_for=("payload_mass", "flow_capacity", "dead_volume"),
    experiment="read the sensor against a reference at two levels",
    convention="reading = factor x truth + bias, of the same column, after its delay.",
    valid="the sensor is straight over its range.",
    signature="an error in proportion to the reading",
)


def read(values: NDArray[np.float64], time: NDArray[np.float64], factor: float) -> NDArray[np.float64]:
    """Return what the sensor shows of the true `values` (n,) at `time` (n,)."""
    return values * factor


def truth(values: NDArray[np.float64], time: NDArray[np.float64], factor: float) -> NDArray[np.float64]:
    """Return what the sensor saw where it shows `values` (n,) at `time` (n,)."""
    return values / factor
