"""The mix of a trial: what is hidden where, at which size, under which instruments."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from exo_sim.trials.conditions import Conditions, Sensors
from exo_sim.trials.hidden_effects import CALIBRATIONS, EFFECTS, LISTED, OUTSIDE, SENSORS
from exo_sim.trials.leg_cases import FORCE, GAS

#: Share of the cases in each cell.
SHARES = {
    "nothing": 0.10,
    "oddities": 0.10,
    "single": 0.36,
    "pair": 0.11,
    "triple": 0.05,
    "outside": 0.06,
    "twin": 0.05,
    "concealed": 0.05,
    "missing_sensor": 0.04,
    "leg": 0.08,
}
#: What a walking leg hides, in an order that mixes gas and force.
LEG = tuple(sorted(GAS + FORCE, key=lambda key: hashlib.sha256(key.encode()).digest()))
#: Sizes of singles, in limits.
LADDER = (0.5, 1.0, 2.0, 4.0, 10.0)
#: Effects that one kind of excitation can hardly tell from another: the effect,
#: and the program that hides the difference.
TWINS = (
    ("coulomb_friction", "holds"),
    ("pressure_dependent_friction", "tracking"),
    ("valve_lag:delay", "valve"),
    ("valve_lag", "tracking"),
    ("valve_null_leakage", "tracking"),
    ("dead_volume", "valve"),
    ("transmission_compliance", "tracking"),
    ("viscous_friction", "holds"),
)
#: Sets of which one case may hide only one: the same field of the machine, or one that contains the other.
EXCLUSIVE = (
    {"coulomb_friction", "asymmetric_friction", "stribeck_friction", "presliding", "dwell_friction"},
    {"wall_heat_transfer", "moving_wall_temperature"},
    {"transmission_compliance", "backlash"},
    {"supply_droop", "supply_regulator"},
    {"line_restriction", "ringing_hose"},
)


#: Cell, effects, sizes, conditions, and whether it is concealed.
_Draft = tuple[str, tuple[str, ...], tuple[float, ...], Conditions, bool]


@dataclass(frozen=True)
class Plan:
    """One case to be made.

    Attributes:
        name: "case_0001".
        cell: Of `SHARES`.
        effects: Keys of `hidden_effects.EFFECTS`.
        times: Size of each in limits.
        seed: Chance.
        conditions: Under what a bench is recorded; a walking leg has its own.
        conceal: Whether the believed numbers are tuned to hide it.
    """

    name: str
    cell: str
    effects: tuple[str, ...]
    times: tuple[float, ...]
    seed: int
    conditions: Conditions = field(default_factory=Conditions)
    conceal: bool = False


def _compatible(keys: tuple[str, ...]) -> bool:
    names = [EFFECTS[key].name for key in keys]
    if len(set(names)) < len(names):
        return False
    return all(len(group & set(names)) < 2 for group in EXCLUSIVE)


def _conditions(rng: np.random.Generator) -> Conditions:
    """Return what differs between good benches: noise, bits, sample rate, number of recordings."""
    sensors = Sensors(pressure_noise=float(rng.choice([150.0, 250.0, 250.0, 400.0])), bits=int(rng.choice([14, 16])))
    rate = float(rng.choice([500.0, 1000.0, 1000.0, 1000.0]))
    recordings = int(rng.choice([1, 1, 1, 1, 1, 2]))
    return Conditions(sensors=sensors, rate=rate, recordings=recordings, supply_recorded=bool(rng.random() < 0.8))


def _with_oddities(plain: Conditions, rng: np.random.Generator) -> Conditions:
    """Return the conditions of a bench with mild oddities: an uneven clock, cards that lag, filters, sensors that drift."""
    jitter = float(rng.choice([0.0, 5e-5]))
    skew, lag = float(rng.uniform(0, 2e-4)), float(rng.uniform(0, 3e-4))
    sensors = replace(plain.sensors, skew=skew, lag=lag, drift=float(rng.normal(0, 300)))
    return replace(plain, oddities=True, jitter=jitter, sensors=sensors)


def draw_plans(count: int, seed: int) -> list[Plan]:
    """Return the plans of a trial, in an order that says nothing about the cells.

    Args:
        count: How many cases.
        seed: Chance.
    """
    rng = np.random.default_rng([seed, 5])
    exact = np.array(list(SHARES.values())) * count
    counts = np.floor(exact).astype(int)
    for cell in np.argsort(counts - exact)[: count - counts.sum()]:
        counts[cell] += 1
    named = LISTED + CALIBRATIONS + SENSORS
    ladder = [(key, times) for times in LADDER for key in LISTED]
    rng.shuffle(ladder)  # type: ignore[arg-type]
    drafts: list[_Draft] = []
    for cell, number in zip(SHARES, counts):
        for i in range(number):
            conditions = _conditions(rng)
            keys: tuple[str, ...] = ()
            times: tuple[float, ...] = ()
            if cell == "oddities":
                conditions = _with_oddities(conditions, rng)
            elif cell == "single":
                key, size = ladder[i % len(ladder)]
                if i % 8 == 7:
                    key = str(rng.choice(CALIBRATIONS + SENSORS))
                keys, times = (key,), (float(size),)
            elif cell in ("pair", "triple"):
                size = 2 if cell == "pair" else 3
                while not keys or not _compatible(keys):
                    keys = tuple(str(key) for key in rng.choice(LISTED, size, replace=False))
                times = tuple(float(t) for t in rng.choice([5.0, 10.0, 20.0], size))
            elif cell == "outside":
                keys, times = (OUTSIDE[i % len(OUTSIDE)],), (10.0,)
            elif cell == "twin":
                key, program = TWINS[i % len(TWINS)]
                keys, times, conditions = (key,), (10.0,), replace(conditions, program=program)
            elif cell == "concealed":
                keys, times = (str(rng.choice(LISTED)),), (10.0,)
            elif cell == "missing_sensor":
                keys, times = (str(rng.choice(named)),), (10.0,)
                gone = str(rng.choice(["piston.pressure_2", "slide.position", "supply.pressure", "piston.pressure_1"]))
                if gone == EFFECTS[keys[0]].where:
                    gone = "supply.pressure"
                conditions = replace(conditions, missing=(gone,))
            elif cell == "leg":
                conditions = Conditions()
                if i % 6 != 5:
                    keys, times = (LEG[i % len(LEG)],), (10.0,)
            drafts.append((cell, keys, times, conditions, cell == "concealed"))
    return _shuffled(drafts, rng)


def every_plan(draws: int, seed: int) -> list[Plan]:
    """Return the plans of a trial that hides each effect alone at ten limits: on a bench, on a bench whose believed numbers
    are tuned to hide it, and on a walking leg.

    Args:
        draws: How often each.
        seed: Chance.
    """
    rng = np.random.default_rng([seed, 6])
    drafts: list[_Draft] = []
    for _ in range(draws):
        drafts += [("single", (key,), (10.0,), _conditions(rng), False) for key in LISTED]
        drafts += [("concealed", (key,), (10.0,), _conditions(rng), True) for key in LISTED]
        drafts += [("leg", (key,), (10.0,), Conditions(), False) for key in LEG]
    return _shuffled(drafts, rng)


def _shuffled(drafts: Sequence[_Draft], rng: np.random.Generator) -> list[Plan]:
    order = rng.permutation(len(drafts))
    seeds = rng.integers(1, 2**31, len(drafts))
    plans = []
    for n, k in enumerate(order):
        cell, keys, times, conditions, conceal = drafts[k]
        plans.append(Plan(f"case_{n + 1:04d}", cell, keys, times, int(seeds[n]), conditions, conceal))
    return plans
