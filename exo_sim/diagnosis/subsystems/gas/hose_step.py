"""How long a fit's steps may be where sensors sit behind a hose: as long as what they are off by stays well below the noise of its rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.correlation import rms
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.policy.recordings import STEP_ERROR
from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs
from exo_sim.diagnosis.subsystems.gas.prediction import HOSE_STEP, run_gas
from exo_sim.diagnosis.subsystems.gas.row_set import RowSet
from exo_sim.physics.effects import line_restriction, valve_lag

#: What is tried beyond the usual step, shortest first [s].
LONGER = (1e-3, 2e-3)
#: What a fit may put into the machine that is tried, beside what is known of it: a hose of so many areas of the valve and so much
#: volume [m^3] between the cylinder and its sensors, and a lag of the valve [s].
TRIED_AREAS, TRIED_VOLUME, TRIED_LAG = 4.0, 1e-5, 5e-3


def affordable_step(inputs: Sequence[GasInputs], rows: RowSet, nominal: PlantParameters) -> float:
    """Return the longest step [s] with which predictions behind a hose are off by no more than `STEP_ERROR` of the noise of the rows.

    Tried is the machine as it is believed to be with a hose between it and its sensors, with and without a lag of its valve.

    Args:
        inputs: Of each run.
        rows: Of all runs.
        nominal: The machine.
    """
    prompt, late = nominal.copy(), nominal.copy()
    for plant in (prompt, late):
        hose = plant.cylinder[line_restriction.EFFECT.name]
        if not hose["area"][0] > 0.0:
            hose["area"], hose["volume"] = TRIED_AREAS * plant.cylinder["valve_area"], TRIED_VOLUME
        hose["length"], hose["sensor"] = 0.0, 1.0
    lag = late.cylinder[valve_lag.EFFECT.name]
    lag["time_constant"] = np.maximum(lag["time_constant"], TRIED_LAG)

    def means(plant: PlantParameters, step: float) -> NDArray[np.float64]:
        stepped = (replace(one, hose_step=step) for one in inputs)
        return rows.means([run_gas(one, plant.world, plant.cylinder, whole=False).pressure for one in stepped])

    usual = [(plant, means(plant, HOSE_STEP)) for plant in (prompt, late)]
    found = HOSE_STEP
    for longer in LONGER:
        if not all(rms(means(plant, longer) - seen) <= STEP_ERROR for plant, seen in usual):
            break
        found = longer
    return found
