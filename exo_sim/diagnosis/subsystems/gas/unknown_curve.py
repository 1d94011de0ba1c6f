"""The curve of an unknown effect, put into the record of a cylinder that the simulator steps with."""

from __future__ import annotations

import numpy as np

from exo_sim.diagnosis.discrepancy.signal import Discrepancy
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.physics.effects import unknown
from exo_sim.physics.effects.unknown import ACTS, DEPENDS_ON, KNOTS


def with_curve(plant: PlantParameters, discrepancy: Discrepancy) -> PlantParameters:
    """Return a plant in which the best curve of a discrepancy acts; the plant itself where no effect can follow its variable.

    The effect has `KNOTS` knots: those that the curve has not lie closely behind its last one and hold its last value.
    """
    best = discrepancy.best
    if best is None or best.variable not in DEPENDS_ON:
        return plant
    changed = plant.copy()
    record = changed.cylinder[unknown.EFFECT.name]
    record["acts"], record["depends_on"] = ACTS.index(discrepancy.acts), DEPENDS_ON.index(best.variable)
    count = len(best.at)
    tail = best.at[-1] + 1e-6 * (1.0 + np.arange(KNOTS - count)) * max(abs(best.at[-1]), 1.0)
    record["at"][0] = np.concatenate([best.at, tail])
    record["values"][0] = np.concatenate([best.values, np.full(KNOTS - count, best.values[-1])])
    return changed
