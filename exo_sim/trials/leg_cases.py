"""Cases of a walking leg: what is hidden sits in one of its cylinders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.trials.conditions import ALL_KNOWN, LegConditions
from exo_sim.trials.hidden_effects import Hidden, find, plant
from exo_sim.trials.truth.bench import CYLINDER, JOINT, believed
from exo_sim.trials.truth.drive import Truth
from exo_sim.trials.truth.instruments import Instrument, measure
from exo_sim.trials.truth.leg import JOINTS, Leg, draw_leg, walk
from exo_sim.trials.truth.machine import Machine

Array = NDArray[np.float64]

#: What pressures, command and joint angle of a leg can show.
GAS = (
    "wall_heat_transfer", "moving_wall_temperature", "piston_leakage", "piston_leakage:laminar", "external_leakage",
    "external_leakage:chamber_2", "external_leakage:porous", "valve_null_leakage", "valve_deadband", "valve_offset",
    "valve_lag", "valve_lag:delay", "valve_hysteresis", "spool_rate_limit", "critical_ratio", "line_restriction",
    "line_restriction:valve_end", "flow_capacity", "dead_volume", "sensor_delay", "sensor_bias", "sensor_scale",
)  # fmt: skip
#: What a load cell on the rod adds.
FORCE = (
    "coulomb_friction", "viscous_friction", "stribeck_friction", "pressure_dependent_friction", "asymmetric_friction",
    "quadratic_drag", "return_spring",
)  # fmt: skip


@dataclass(frozen=True)
class LegCase:
    """A case of a leg before it is written; see `cases.Case`. `instruments` are those of pressures and rod forces."""

    name: str
    bench: Leg
    believed: Leg
    machines: Mapping[str, Machine]
    joint: str
    hidden: tuple[Hidden, ...]
    truth: Mapping[str, Truth]
    recordings: tuple[dict[str, Array], ...]
    instruments: tuple[Instrument, Instrument]
    about: Mapping[str, object] = field(default_factory=dict)


def make_leg_case(
    name: str,
    effects: Sequence[str] = (),
    seed: int = 0,
    size: float | Sequence[float] = 1.0,
    conditions: LegConditions | None = None,
) -> LegCase:
    """Draw a case of a walking leg.

    Args:
        name: Its name.
        effects: Of `GAS` and `FORCE`; the latter need the load cell.
        seed: Seed of the random numbers; the same seed gives the same case.
        size: As in `cases.make_case`.
        conditions: Under what it is recorded; those of a good laboratory when absent.

    Raises:
        TrialError: an effect is unknown or cannot be on a leg, or the drawn machine diverged.
    """
    under = conditions or LegConditions()
    rng = np.random.default_rng([seed, 20261])
    wanted = [find(key) for key in effects]
    for key in effects:
        if key not in GAS + FORCE:
            raise TrialError(f"{key} cannot be planted in a leg; there is: {', '.join(GAS + FORCE)}")
    needs = {need for effect in wanted for need in effect.known}
    known = under.known
    if known is None:
        known = ALL_KNOWN if rng.random() < 0.5 else ()
    chance = bool(rng.random() < 0.5)
    names = {effect.name for effect in wanted}
    if "asymmetric_friction" in names:
        names |= {"coulomb_friction"}
    owner_knows = tuple(key for key in ALL_KNOWN if (key in known or key in needs) and key not in names)
    leg = draw_leg(rng, owner_knows)
    joint = str(rng.choice(JOINTS))
    bench = leg.cylinders[joint]
    sizes = [float(size)] * len(wanted) if isinstance(size, int | float) else [float(s) for s in size]
    hidden = []
    for i, (effect, s) in enumerate(zip(wanted, sizes)):
        where = effect.where.replace(CYLINDER, joint).replace(JOINT, joint)
        entry = plant(effect, bench, s, seed * 31 + i)
        hidden.append(replace(entry, effect=replace(effect, where=where, synonyms=())))
    machines = {
        name_: one.machine().with_(load_mass=1.0, gravity=0.0, damping=0.0, spring_stiffness=0.0)
        for name_, one in leg.cylinders.items()
    }
    for entry in hidden:
        machines[joint] = entry.into(machines[joint], bench)
    spread = (0.02 * under.errors, 0.05 * under.errors, 0.0, 0.01 * under.errors)
    own = Leg({key: believed(one, rng, *spread) for key, one in leg.cylinders.items()})
    angles, truths = walk(leg, machines, under.duration, under.rate, rng)
    cell = under.load_cell if under.load_cell is not None else chance or bool(set(effects) & set(FORCE))
    pressure = Instrument(noise=under.pressure_noise, bits=16, low=0.0, high=4e6)
    angle = Instrument(noise=under.angle_noise, bits=16, low=-3.2, high=3.2)
    force = Instrument(noise=under.force_noise, bits=16, low=-3e3, high=3e3)
    time = truths[joint].log["time"]
    table = {"time [s]": time}
    for key, truth in truths.items():
        at_valve = key == joint and any(entry.parameters.get("sensor_at_valve", 0) for entry in hidden)
        table[f"{key}.valve_command [1]"] = truth.log["command"]
        for number in ("1", "2"):
            column = f"{key}.pressure_{number}"
            true = truth.log[f"line_{number}" if at_valve else f"pressure_{number}"]
            table[f"{column} [Pa]"] = measure(time, true, with_faults(pressure, column, hidden), rng)
        if cell:
            table[f"{key}.force [N]"] = measure(time, truth.log["force"], force, rng)
    for key, values in angles.items():
        table[f"{key}.position [rad]"] = measure(time, values, angle, rng)
    if under.supply_recorded:
        table["supply.pressure [Pa]"] = measure(time, truths[joint].log["supply"], pressure, rng)
    about = {"seed": seed, "known": list(owner_knows), "load_cell": cell, "walks": True}
    return LegCase(name, leg, own, machines, joint, tuple(hidden), truths, (table,), (pressure, force), about)


def with_faults(instrument: Instrument, column: str, hidden: Sequence[Hidden]) -> Instrument:
    """Return the instrument with the sensor effects that are planted in this column."""
    for entry in hidden:
        if entry.effect.where == column:
            p = entry.parameters
            instrument = replace(
                instrument, delay=p.get("seconds", 0.0), bias=p.get("value", 0.0), scale=p.get("factor", 1.0)
            )
    return instrument


def actual(case: LegCase) -> dict[str, Any]:
    """Return the true factors on what the owner believes of the cylinder in question."""
    machine, own = case.machines[case.joint], case.believed.cylinders[case.joint]
    return {
        "flow_capacity": machine["valve_area"] / own.valve_area,
        "dead_volume": (machine["dead_1"] + machine["dead_2"]) / (own.dead_1 + own.dead_2),
    }

