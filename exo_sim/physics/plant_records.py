"""The numbers that a plant is made of, as records that compiled functions read by name.

The fields of an effect are those of its declaration: a new file in `effects/` appears here by itself. Zero is "off".
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.declaration import Effect, declared


def _fields(place: str) -> list[tuple[str, np.dtype]]:
    return [(effect.name, _record(effect)) for effect in declared().values() if place in effect.places]


def _record(effect: Effect) -> np.dtype:
    fields = [(p.name, np.float64, (p.most,)) if p.most else (p.name, np.float64) for p in effect.parameters]
    return np.dtype(fields, align=True)


#: What resists the motion of one sliding or turning part, by effect; and the mass it moves [kg or kg m^2] in steps of `step` s.
JOINT = np.dtype(
    [("effective_mass", np.float64), ("turning", np.float64), ("step", np.float64), *_fields("joint")], align=True
)

#: One cylinder with its valve, and every effect that can act on it. `arm` is dX/dq of the joint it drives [m/rad or 1];
#: `tank_area` that of the paths between each chamber and the recovery tank [m^2].
CYLINDER = np.dtype(
    [
        ("area_1", np.float64),
        ("area_2", np.float64),
        ("stroke", np.float64),
        ("dead_volume_1", np.float64),
        ("dead_volume_2", np.float64),
        ("single_acting", np.float64),
        ("valve_area", np.float64),
        ("independent", np.float64),
        ("tank_area", np.float64),
        ("vented", np.float64),
        ("effective_mass", np.float64),
        ("turning", np.float64),
        ("step", np.float64),
        ("arm", np.float64),
        ("drive_stiffness", np.float64),
        ("drive_gap", np.float64),
        *_fields("cylinder"),
    ],
    align=True,
)

#: The gas, the atmosphere and what all cylinders share. Pressures and temperatures may be set anew at every step.
#: `tank_volume` is that of the recovery tank [m^3], 0 where there is none, `tank_pressure` the one that it is kept near [Pa].
#: `longest_step` [s] and `most_steps` bound how finely a call is divided; 0 leaves that to `step_length.py`.
WORLD = np.dtype(
    [
        ("k", np.float64),
        ("r", np.float64),
        ("atmosphere", np.float64),
        ("ambient", np.float64),
        ("supply_pressure", np.float64),
        ("supply_temperature", np.float64),
        ("exhaust_pressure", np.float64),
        ("tank_volume", np.float64),
        ("tank_pressure", np.float64),
        ("longest_step", np.float64),
        ("most_steps", np.float64),
        *_fields("supply"),
        *_fields("exhaust"),
    ],
    align=True,
)


def switch_off(world: NDArray[np.void], places: Collection[str]) -> None:
    """Switch off the effects of shared parts, in place: a pressure measured there contains what they do already.

    Args:
        world: Record WORLD, shape (1,).
        places: Of "supply" and "exhaust".
    """
    for effect in declared().values():
        if effect.places[0] in places:
            world[effect.name] = np.zeros(1, world[effect.name].dtype)
