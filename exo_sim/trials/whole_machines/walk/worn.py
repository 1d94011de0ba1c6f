"""A worn machine, drawn: its cylinders, and what each of them hides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from exo_sim.trials.whole_machines.draw import Built, build
from exo_sim.trials.whole_machines.hidden_effects import COMMON, OUTSIDE, SEAL
from exo_sim.trials.whole_machines.make import Make
from exo_sim.trials.whole_machines.walk.anatomy import Seat, draw_seats, reach
from exo_sim.trials.whole_machines.walk.gait import JOINTS

#: What only a load cell shows while a wearer leads the motion.
_SHOWN_BY_FORCE = (*SEAL, "pressure", "asymmetry")
_OUTSIDE = tuple(key for key in OUTSIDE if key in ("relief", "edges", "curve"))


@dataclass(frozen=True)
class Worn:
    """A worn machine as built.

    Attributes:
        cylinders: By joint; each one's make calls cylinder and joint by that name.
        seats: By joint.
        load_cells: Whether rod forces are recorded.
    """

    cylinders: Mapping[str, Built]
    seats: Mapping[str, Seat]
    load_cells: bool


def draw_worn(make: Make, cell: str, rng: np.random.Generator, only: Sequence[str] = (), bulk: float = 1.0) -> Worn:
    """Draw a worn machine.

    Args:
        make: One whose build is "legs".
        cell: Of `draw.CELLS`: "whole" hides effects in one to four cylinders, the same in each of them two times in five.
        rng: Chance.
        only: Keys of what is hidden in each affected cylinder, instead of a draw.
        bulk: Factor on the sizes of what it has.
    """
    seats = draw_seats(rng)
    names = JOINTS if rng.random() < 0.7 else JOINTS[:2]
    needs_force = bool(set(only) & set(_SHOWN_BY_FORCE))
    load_cells = bool(rng.random() < 0.5) or needs_force
    plans = _plans(make, cell, rng, only, names, load_cells)
    cylinders: dict[str, Built] = {}
    shared: dict[str, float] = {}
    for name in names:
        own = replace(make, cylinder=name, joint=name)
        low, high = reach(name, seats[name])
        one = build(own, cell, rng, bulk=bulk, travel=high - low, blocks=plans[name])
        shared = shared or {key: one.machine[key] for key in ("supply", "ambient", "room")}
        retracted = 0.5 * (low + high) - 0.5 * one.machine["stroke"]
        cylinders[name] = replace(one, machine=one.machine.with_(**shared, lever_length=retracted))
    return Worn(cylinders, {name: seats[name] for name in names}, load_cells)


def _plans(
    make: Make, cell: str, rng: np.random.Generator, only: Sequence[str], names: Sequence[str], load_cells: bool
) -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
    """Return for each cylinder what is hidden and what its owner knows of; seals rub whether anything shows it or not."""
    pool = [key for key in (*COMMON, *make.optional) if load_cells or key not in _SHOWN_BY_FORCE]
    pool = [key for key in pool if key not in ("wall", str(rng.choice(["leak_out", "leak_piston"])))]
    pool += list(SEAL) if load_cells else []
    affected = {str(name) for name in rng.permutation(names)[: int(rng.integers(1, len(names) + 1)) if cell == "whole" else 1]}
    alike = rng.random() < 0.4
    sets = {name: _hidden(pool, cell, rng, only) for name in names}
    if alike:
        sets = dict.fromkeys(names, sets[names[0]])
    disclosed = tuple(key for key in COMMON if key in pool and rng.random() < 0.3)
    disclosed += SEAL if load_cells or rng.random() < 0.5 else ()
    plans = {}
    for name in names:
        hidden = sets[name] if name in affected and cell != "nothing" else ()
        plans[name] = (hidden, tuple(key for key in disclosed if key not in hidden))
    return plans


def _hidden(pool: Sequence[str], cell: str, rng: np.random.Generator, only: Sequence[str]) -> tuple[str, ...]:
    if only:
        return tuple(only)
    if cell == "outside":
        return (str(rng.choice(_OUTSIDE)),)
    count = min(int(rng.choice([1, 2, 3, 4, 5, 7])), len(pool)) if cell == "whole" else 1
    chosen = [str(key) for key in rng.permutation(pool)[:count]]
    return tuple(chosen)
