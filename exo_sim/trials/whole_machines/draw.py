"""A machine of a make, drawn: its cylinder, load and valve, and the blocks that it has."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from exo_sim.errors import TrialError, nearest
from exo_sim.trials.whole_machines.effect_sizes import Draft
from exo_sim.trials.whole_machines.friction_laws import TANH
from exo_sim.trials.whole_machines.hidden_effects import BLOCKS, COMMON, OUTSIDE, SEAL
from exo_sim.trials.whole_machines.machine import Machine
from exo_sim.trials.whole_machines.make import Make
from exo_sim.trials.whole_machines.published_cylinders import SERIES

GRAVITY = 9.81
CELLS = ("whole", "single", "nothing", "outside")
#: Blocks of which a machine has at most one.
_EXCLUSIVE = ({"tank", "regulator"}, {"leak_out", "leak_piston"})


@dataclass(frozen=True)
class Built:
    """A machine as built.

    Attributes:
        make: Which make.
        bore, rod: As its data sheet says [m]; the machine's areas differ a little.
        machine: Its numbers.
        hidden, known: Keys of `hidden_effects.BLOCKS`: what its owner does not know of, and what stands in his rig.
        lever_centre: Distance of a lever's mass centre from its joint [m], 0 on a slide.
        mass: What moves [kg], the piston included on a slide.
    """

    make: Make
    bore: float
    rod: float
    machine: Machine
    hidden: tuple[str, ...]
    known: tuple[str, ...]
    lever_centre: float
    mass: float

    @property
    def full_speed(self) -> float:
        """About how fast the piston moves at full command [m/s]."""
        m = self.machine
        return m["valve_area"] * m["sonic"] * m["gas_constant"] * math.sqrt(m["room"]) / (0.75 * m["area_1"])

    @property
    def natural(self) -> float:
        """About the natural frequency of the load on the gas at mid-stroke [rad/s]."""
        m = self.machine
        volume = 0.5 * (m["dead_1"] + m["dead_2"] + m["area_1"] * m["stroke"])
        behind = m["area_2"] ** 2 if m["single_acting"] == 0 else 0.0
        stiffness = 1.3 * 0.6 * m["supply"] * (m["area_1"] ** 2 + behind) / volume
        return math.sqrt(stiffness / m.moved_mass)


def cells_of(words: str, cells: Sequence[str] = CELLS) -> tuple[str, ...]:
    """Return the cells of a list such as "whole,single", or all.

    Raises:
        TrialError: there is no such cell.
    """
    chosen = tuple(cells) if words == "all" else tuple(name.strip() for name in words.split(","))
    for name in chosen:
        if name not in cells:
            raise TrialError(f'no cell "{name}"{nearest(name, cells)}')
    return chosen


def choose(make: Make, cell: str, rng: np.random.Generator, only: Sequence[str] = ()) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the keys of what is hidden and of what the owner knows.

    Args:
        make: The make.
        cell: Of `CELLS`.
        rng: Chance.
        only: What is hidden, instead of a draw.
    """
    there = [key for key, chance in COMMON.items() if rng.random() < chance]
    if make.single:  # what passes the piston is gone, as through any other leak
        there = ["leak_out" if key == "leak_piston" else key for key in there if key != "leak_piston" or "leak_out" not in there]
    if {"leak_out", "leak_piston"} <= set(there):
        there.remove(str(rng.choice(["leak_out", "leak_piston"])))
    extra = [str(key) for key in rng.permutation(make.optional)][: int(rng.choice([0, 1, 2], p=[0.35, 0.45, 0.2]))]
    for group in _EXCLUSIVE:
        while len(group & set(extra)) > 1:
            extra.pop()
    if "cushion" in extra and "hose" not in there:
        there.append("hose")
    if "wall" in extra and "heat" not in there:
        there.append("heat")
    present = [*SEAL, *there, *extra]
    if only:
        present = list(dict.fromkeys([*present, *only]))
        for group in _EXCLUSIVE:
            if group & set(only):
                present = [key for key in present if key in only or key not in group]
        hidden = list(only)
        if cell == "whole":
            present = list(dict.fromkeys([*only, *(key for key in present if rng.random() < 0.3)]))
    elif cell == "whole":
        count = int(rng.integers(5, 9))
        rest = [str(key) for key in rng.permutation([*there, *extra])]
        hidden = [*SEAL, *rest[: count - len(SEAL)]]
        # of what is left some stands in the rig, the rest is not there
        present = [*hidden, *(key for key in rest[count - len(SEAL) :] if rng.random() < 0.5)]
    elif cell == "single":
        hidden = [str(rng.choice(present))]
        if hidden[0] == "coulomb" and "asymmetry" in present:
            present.remove("asymmetry")
    elif cell == "outside":
        hidden = [str(rng.choice(OUTSIDE))]
        present.append(hidden[0])
    else:
        hidden = []
    if "cushion" in present and "hose" not in present:
        present.append("hose")
    if "wall" in present and "heat" not in present:
        present.append("heat")
    if "heat" in hidden and "wall" not in hidden and "wall" in present:
        present.remove("wall")  # who does not know that a wall takes heat does not know that it warms
    if make.single and make.build == "slide" and "spring" not in hidden:
        present.append("spring")  # which a data sheet gives
    known = tuple(dict.fromkeys(key for key in present if key not in hidden))
    return tuple(hidden), known


def build(make: Make, cell: str, rng: np.random.Generator, only: Sequence[str] = (), bulk: float = 1.0, *, travel: float = 0.0,
          blocks: tuple[Sequence[str], Sequence[str]] | None = None) -> Built:  # fmt: skip
    """Draw a machine.

    Args:
        make: Its make.
        cell: Of `CELLS`.
        rng: Chance.
        only: Keys of what is hidden, instead of a draw.
        bulk: Factor on the sizes of what it has, 1 for real ones.
        travel: Of a piston that is led [m]; its cylinder is the shortest that allows for it.
        blocks: What is hidden and what is known, instead of a draw.
    """
    size = SERIES[make.series][float(rng.choice(make.bores))]
    enough = [stroke for stroke in size.strokes if stroke > 1.15 * travel] or [1.2 * travel]
    stroke = enough[0] if travel else float(rng.choice(size.strokes))
    supply = 101325.0 + float(rng.uniform(3.8e5, 6.6e5))
    ambient = float(rng.uniform(9.75e4, 1.025e5)) if make.grade.gauge else 101325.0
    speed = min(float(rng.uniform(0.35, 1.0)), 5.0 * stroke)
    area = size.area * (1 + float(rng.normal(0, 0.003)))
    rod_area = 0.25 * math.pi * size.rod**2
    room = float(rng.uniform(289.0, 299.0))
    valve = speed * 0.75 * area / (0.040418 * 287.05 * math.sqrt(room))
    draft = Draft(make, size, stroke, supply, valve, rng, bulk)
    swept = size.area * stroke
    dead = 0.5e-6 + swept * rng.uniform(0.05, 0.16, 2)
    piston_mass = 0.01 + 2.2e3 * size.area * (0.012 + 0.02 * size.bore / 0.032)
    values: dict[str, float] = {
        "ambient": ambient,
        "room": room,
        "area_1": area,
        "area_2": area - rod_area,
        "stroke": stroke,
        "dead_1": float(dead[0]),
        "dead_2": float(dead[1]),
        "piston_mass": piston_mass,
        "supply": supply,
        "valve_area": valve,
    }
    centre, mass = _load(values, draft, piston_mass)
    hidden, known = choose(make, cell, rng, only) if blocks is None else (tuple(blocks[0]), tuple(blocks[1]))
    values |= {"contact_law": make.laws.contact, "stribeck_law": make.laws.stribeck, "pressure_law": make.laws.pressure}
    values |= {"heat_law": make.laws.heat, "leak_law": make.laws.leak}
    for key in [*known, *hidden]:
        values |= BLOCKS[key].draw(draft)
    if travel:
        values |= {"led": 1.0, "gravity": 0.0, "damping": 0.0, "zero": 0.0}
    if make.single:
        values |= {"single_acting": 1.0, "leak_2": 0.0, "leak_1": values.get("leak_1", 0.0) + values.get("leak_2", 0.0)}
        if make.build == "slide":
            values |= _brought_back(draft)
    machine = Machine(values)
    # an end stop that gives a few millimetres to the fastest load
    machine = machine.with_(stop_stiffness=9e4 * machine.moved_mass + 5e4, stop_damping=120.0 * machine.moved_mass)
    if "mount" in (*hidden, *known):
        # a mount rings with the piston between the gas and the load; some of it is lost
        machine = machine.with_(mount_damping=0.12 * math.sqrt(machine["mount_stiffness"] * piston_mass))
    if any(key in (*hidden, *known) for key in (*SEAL, "pressure")):
        machine = machine.with_(**_contact(machine, draft))
    return Built(make, size.bore, size.rod, machine, hidden, known, centre, mass)


def _load(values: dict[str, float], d: Draft, piston_mass: float) -> tuple[float, float]:
    """Write the load's fields; return the lever's mass centre and what moves."""
    mass = d.between(0.3, 1.0) * d.size.load
    if d.make.build != "lever":
        if d.make.build == "upright":
            mass = min(mass, d.between(0.15, 0.4) * d.thrust / GRAVITY)
            values["gravity"] = (mass + piston_mass) * GRAVITY
        values |= {"inertia": mass, "damping": d.between(0.0, 0.4) * d.bore_mm, "zero": float(d.rng.choice([0.0, 0.5])) * d.stroke}
        return 0.0, mass + piston_mass
    arm = d.between(0.55, 0.68) * d.stroke
    base = d.between(1.9, 2.6) * d.stroke
    centre = d.between(1.2, 2.2) * arm
    mass = min(mass, d.between(0.08, 0.22) * d.thrust * arm / (centre * GRAVITY))
    angle = math.pi / 2 + d.between(-0.15, 0.15)
    middle = math.sqrt(arm**2 + base**2 - 2 * arm * base * math.cos(angle))
    values |= {
        "lever": 1.0,
        "inertia": mass * centre**2 * d.between(1.05, 1.2),
        "gravity": mass * GRAVITY * centre,
        "damping": 0.02 * mass * centre**2,
        "lever_arm": arm,
        "lever_base": base,
        "lever_angle": angle,
        "lever_length": middle - 0.5 * d.stroke,
    }
    return centre, mass


def _brought_back(d: Draft) -> dict[str, float]:
    """Return a spring that is wound up over all of the stroke."""
    return {"spring": d.between(0.1, 0.18) * d.thrust / d.stroke, "spring_rest": -d.between(0.7, 1.2) * d.stroke}


def _contact(machine: Machine, d: Draft) -> dict[str, float]:
    """Return how the contact comes to its level of friction."""
    if d.make.laws.contact == TANH:
        return {"smooth_speed": d.decade(5e-4, 2e-3)}
    peak = max(machine["coulomb"] + machine["breakaway_excess"], 0.1 * d.bore_mm)
    stiffness = peak / d.decade(3e-5, 1.5e-4)
    mass = machine["piston_mass"] if machine["mount_stiffness"] > 0 else machine.moved_mass
    return {"bristle_stiffness": stiffness, "bristle_damping": d.between(0.1, 0.5) * math.sqrt(stiffness * mass)}
