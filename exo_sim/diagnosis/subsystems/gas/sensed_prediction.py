"""What the sensors of a cylinder would show of its predicted gas: gains, zeros and delays of theirs between the gas and the columns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import PlantParameters, card_delays
from exo_sim.diagnosis.subsystems.gas.initial_temperature import warmth
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs, with_late_pressures
from exo_sim.diagnosis.subsystems.gas.prediction import GasPrediction, run_gas

Array = NDArray[np.float64]


def sensed(given: GasInputs, plant: PlantParameters, shift: float = 0.0, whole: bool = True) -> GasPrediction:
    """Return the prediction of one run with pressures as the plant's sensors show them.

    Args:
        given: The inputs, as sensors showed them.
        plant: The machine and its sensors.
        shift: Added to the initial pressures of all windows [Pa], as in `run_gas`.
        whole: Whether anything but the pressures is asked for.
    """
    sensors = plant.sensors
    late = (sensors.get("pressure_1.delay", 0.0), sensors.get("pressure_2.delay", 0.0))
    if any(late):
        given = with_late_pressures(given, late)
    length_scale = sensors.get("position.scale", 1.0)
    offset = (sensors.get("pressure_1.bias", 0.0), sensors.get("pressure_2.bias", 0.0))
    scale = np.array([sensors.get("pressure_1.scale", 1.0), sensors.get("pressure_2.scale", 1.0)])
    plain = length_scale == 1.0 and (scale == 1.0).all()
    if not plain:
        given = _without_gains(given, length_scale, scale, np.array(offset))
    if (supply := sensors.get("supply.scale", 1.0)) != 1.0:
        given = replace(given, supply=supply * given.supply)
    length_delay, card_delay = card_delays(sensors)
    out = run_gas(given, plant.world, plant.cylinder, shift, length_delay, offset, whole, card_delay, warmth(sensors, given.run))
    pressure = out.pressure
    before = pressure.copy() if whole else None
    for side in range(2):  # column by column: a pair is broadcast along so many rows at a fifth of the speed
        if scale[side] != 1.0:
            pressure[:, side] *= scale[side]
        if offset[side] != 0.0:
            pressure[:, side] += offset[side]
        if late[side] != 0.0:
            pressure[:, side] = np.interp(given.time - late[side], given.time, pressure[:, side])
    return GasPrediction(pressure, out.inside, out.drawn, out.temperature, before, out.samples)


def _without_gains(given: GasInputs, length_scale: float, scale: Array, offset: Array) -> GasInputs:
    """Return the inputs with the gains of the sensors taken off."""
    pressure = (given.windows.pressure - offset) / scale + offset
    return replace(given, length=given.length / length_scale, windows=replace(given.windows, pressure=pressure))
