"""The designs that a search starts from: the owner's, and draws around it that survive screening."""

from __future__ import annotations

import numpy as np

from exo_sim.rig import Rig
from exo_sim.sizing.design_space import MOST_ABOVE, Space
from exo_sim.sizing.loads import JointLoads
from exo_sim.sizing.screening import chosen_bores, screen

_DRAWS = 12


def first_design(rig: Rig, space: Space, loads: tuple[JointLoads, ...], number: int, seed: int) -> dict[str, float]:
    """Return the variables of one of the first designs; number 0 is the owner's, as near as the space allows.

    Draws come nearer to the owner's geometry until one survives; the last one is taken as it is.

    Args:
        rig: The owner's machine.
        space: What may be chosen.
        loads: What the joints must carry.
        number: Which.
        seed: Of the draws.
    """
    own = space.owners(rig)
    if number == 0:
        return own
    chance = np.random.default_rng([seed, number, 1])
    numbers = own
    for attempt in range(_DRAWS):
        numbers = _draw(space, own, 1.0 - attempt / _DRAWS, chance)
        bores = chosen_bores(rig, space, loads, numbers)
        if screen(rig, space.kinds, loads, space.design(numbers, bores)).survives:
            break
    return numbers


def _draw(space: Space, own: dict[str, float], spread: float, chance: np.random.Generator) -> dict[str, float]:
    numbers = dict(own)
    for name, (low, high) in space.bounds.items():
        if name == "supply":
            numbers[name] = float(chance.uniform(low, high))
        elif name.endswith(".valve"):
            numbers[name] = float(np.exp(chance.uniform(np.log(low), np.log(high))))
        else:
            numbers[name] = own[name] + spread * float(chance.uniform(low - own[name], high - own[name]))
    for kind in space.kinds:
        numbers[f"{kind.name}.above"] = float(chance.integers(0, MOST_ABOVE + 1))
    return numbers
