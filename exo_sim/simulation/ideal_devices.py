"""What ideal devices would save a wearer: without mass, each for one joint of both legs and one direction of its moment.

After Dembia, Silder, Uchida, Hicks and Delp (2017, PLoS ONE 12:e0180320): the motion stays as it is, and a device gives any torque. They
distribute it over muscles; here a joint's moment is one thing, so that a device does best to take all of it while it has the device's
direction. What a muscle over two joints would gain elsewhere cannot be seen this way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine import metabolism
from exo_sim.machine.metabolism import Metabolic
from exo_sim.simulation.wearer_inverse_dynamics import Held

#: Names of the directions of a joint's moment, positive first, in the order of `Held.moments`.
DIRECTIONS = {"hip": ("flexion", "extension"), "knee": ("extension", "flexion"), "ankle": ("dorsiflexion", "plantarflexion")}


@dataclass(frozen=True)
class IdealDevice:
    """A device for one joint of both legs and one direction.

    Attributes:
        joint, direction: Keys and values of `DIRECTIONS`.
        cost: The wearer's metabolic power with it [W].
        torque: The most that it gives at one leg [N m].
        power: The most that it gives at both legs together [W].
    """

    joint: str
    direction: str
    cost: Metabolic
    torque: float
    power: float


def cost(powers: NDArray[np.float64], sole_powers: NDArray[np.float64], mass: float) -> Metabolic:
    """Return the metabolic power of a cycle as the ledger reckons it: what a foot takes below the ankle costs nothing.

    Args:
        powers: Of the joints at evenly spaced phases of a cycle [W], shape (n, 6).
        sole_powers: Of the feet below the ankles [W], shape (n, 2).
        mass: Of the wearer's body [kg].
    """
    positive = np.maximum(powers, 0.0).mean(axis=0).sum() + np.maximum(sole_powers, 0.0).mean(axis=0).sum()
    return metabolism.power(float(positive), float(np.minimum(powers, 0.0).mean(axis=0).sum()), mass)


def devices(wearer: Held, mass: float) -> tuple[IdealDevice, ...]:
    """Return what each ideal device makes of a cycle of a wearer's, in the order of `DIRECTIONS`.

    Args:
        wearer: Along one cycle, without any device; rows evenly spaced.
        mass: Of the wearer's body [kg].
    """
    found = []
    for k, (joint, directions) in enumerate(DIRECTIONS.items()):
        for direction, sign in zip(directions, (1.0, -1.0)):
            given = sign * np.maximum(sign * wearer.moments[:, k::3], 0.0)
            left = wearer.moments.copy()
            left[:, k::3] -= given
            taken = (given * wearer.rates[:, k::3]).sum(axis=1)
            it = cost(left * wearer.rates, wearer.sole_powers, mass)
            found.append(IdealDevice(joint, direction, it, float(np.abs(given).max()), float(taken.max())))
    return tuple(found)
