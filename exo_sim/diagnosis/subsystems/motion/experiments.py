"""Motions that could be imposed on one piston or joint, and what a plant says resists them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET
from exo_sim.diagnosis.subsystems.motion.resistance import resistance_along

Array = NDArray[np.float64]

#: Samples of an experiment [s] and its length [s].
STEP, LENGTH = 5e-3, 10.0


def resisted(low: float, high: float, gauge: float, plants: Sequence[PlantParameters], arm: float = 1.0) -> dict[str, Array]:
    """Return, by what is to be done, the force that a balance would show of each plant, against it, shape (plants, n) [N, N m].

    It is what resists less a constant force that sensors make up, which friction of two directions is as well. Where both chambers are
    open to the room no sensor of a pressure makes up any.

    Args:
        low, high: Ends of the stroke that was seen [m, rad].
        gauge: Highest pressure that was seen, above the atmosphere [Pa]; 0 without a cylinder.
        plants: Whose record of the cylinder holds what resists.
        arm: The lever between it and the balance [m/rad, or 1].
    """
    time = np.arange(0.0, LENGTH, STEP)
    middle, swing = 0.5 * (low + high), 0.5 * (high - low)
    both_ways = 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * time / LENGTH))
    paths = {
        "slowly and steadily over the whole stroke and back": middle + swing * both_ways,
        "to and fro once a second over the whole stroke": middle + swing * np.sin(2.0 * np.pi * time),
        "by a hundredth of the stroke to and fro, about one place after the other": middle
        + 0.9 * swing * both_ways + 0.02 * swing * np.sin(4.0 * np.pi * time),
    }  # fmt: skip
    levels = {"": (0.0, 0.0)}
    known = " with both chambers open to the room"
    if gauge > 0.0:
        levels = {
            known: (0.0, 0.0), " at the highest pressure in both chambers": (gauge, gauge),
            " at half that pressure": (0.5 * gauge, 0.5 * gauge), " with one chamber at that pressure": (gauge, 0.0),
        }  # fmt: skip
    found = {}
    for way, path in paths.items():
        for level, pressures in levels.items():
            forces = np.empty((len(plants), len(time)))
            for force, plant in zip(forces, plants, strict=True):
                gauges = np.tile(np.array(pressures), (len(time), 1))
                resistance_along(plant.cylinder[0], time, path, np.gradient(path, time), gauges, force)
                force -= 0.0 if level == known else plant.sensors.get(FORCE_OFFSET, 0.0) / arm
            found[f"move it {way}{level}"] = forces
    return found
