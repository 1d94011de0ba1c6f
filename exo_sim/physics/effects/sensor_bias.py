"""A sensor that is off by a constant."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.declaration import Effect, Parameter

EFFECT = Effect(
    name="sensor_bias",
    places=("column",),
    family="sensor",
    question="Is one channel off by the same amount at rest and at work?",
    says="The sensor reads too much or too little by a constant.",
    parameters=(Parameter("value", "column", -1e9, 1e9, (-5e3, 5e3), "0.25-1 % of full scale"),),
    cut="sensor",
    reveals=(),
    mistaken_for=("asymmetric_friction", "valve_offset", "external_leakage"),
    experiment="take away what the sensor measures (vent the chamber, unload the cell) and read what it still shows",
    convention="reading = factor x truth + bias, of the same column, after its delay.",
    valid="the offset stays over the recording.",
    signature="the same error at every level and speed",
)


def read(values: NDArray[np.float64], time: NDArray[np.float64], value: float) -> NDArray[np.float64]:
    """Return what the sensor shows of the true `values` (n,) at `time` (n,)."""
    return values + value


def truth(values: NDArray[np.float64], time: NDArray[np.float64], value: float) -> NDArray[np.float64]:
    """Return what the sensor saw where it shows `values` (n,) at `time` (n,)."""
    return values - value
