"""One case of a worn machine: a gait led by its wearer, effects in one to four of its cylinders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.trials.whole_machines.case import beside, hidden_of, laws_of, write_files
from exo_sim.trials.whole_machines.draw import Built
from exo_sim.trials.whole_machines.excitation import Program, gains
from exo_sim.trials.whole_machines.hidden_effects import BLOCKS, check_keys
from exo_sim.trials.whole_machines.instruments import Rack, draw_rack, filtered, shown
from exo_sim.trials.whole_machines.loop import FED, FORCES, MEMO
from exo_sim.trials.whole_machines.machine_run import Run, Ticks, advance, span_of, ticks
from exo_sim.trials.whole_machines.make import Make
from exo_sim.trials.whole_machines.makes import find
from exo_sim.trials.whole_machines.materiality import matters
from exo_sim.trials.whole_machines.nearest_effects import rig_effects
from exo_sim.trials.whole_machines.owner_rig import as_built, believed
from exo_sim.trials.whole_machines.plant import STATES, at_rest
from exo_sim.trials.whole_machines.walk.anatomy import WornOwner
from exo_sim.trials.whole_machines.walk.gait import gait
from exo_sim.trials.whole_machines.walk.worn import Worn, draw_worn

Array = NDArray[np.float64]
_TRIES = 12


@dataclass(frozen=True)
class Walk:
    """A recording's truth: each cylinder's run, and the angles of the joints in each row of their logs, by joint."""

    runs: Mapping[str, Run]
    angles: Mapping[str, Array]


@dataclass(frozen=True)
class WornCase:
    """One case before it is written; see `whole.case.WholeCase`, each by joint."""

    name: str
    cell: str
    seed: int
    make: Make
    worn: Worn
    racks: Mapping[str, Rack]
    columns: tuple[str, ...]
    believed: WornOwner
    nearest: WornOwner
    recordings: tuple[Mapping[str, Array], ...]
    fresh: Mapping[str, Array]
    matter: Mapping[str, Mapping[str, Mapping[str, float]]]


def make_worn_case(name: str, make: str, cell: str = "whole", seed: int = 0, *, effects: Sequence[str] = (), bulk: float = 1.0,
                   duration: float = 20.0, recordings: int = 1, weigh: bool = True) -> WornCase:  # fmt: skip
    """Draw a case; arguments as in `whole_machines.case.make_case`.

    Raises:
        TrialError: a make or effect is unknown, or twelve machines in a row diverged.
    """
    kind = find(make)
    check_keys(effects)
    for attempt in range(_TRIES):
        rng = np.random.default_rng([seed, *map(ord, make), attempt, 20263])
        worn = draw_worn(kind, cell, rng, effects, bulk)
        try:
            walks = [walk(worn, kind, kind.programs, duration, rng) for _ in range(recordings)]
            unseen = walk(worn, kind, kind.fresh, 0.6 * duration, rng)
        except TrialError:
            continue
        return _case(name, cell, seed, kind, worn, walks, unseen, weigh, rng)
    raise TrialError(f"make {make}, seed {seed}: {_TRIES} worn machines in a row diverged; draw with another --seed")


def walk(worn: Worn, make: Make, names: tuple[str, ...], duration: float, rng: np.random.Generator) -> Walk:
    """Let somebody walk, the valves following forces; standing, they are closed.

    Raises:
        TrialError: a cylinder left the range of numbers that mean anything.
    """
    dt = min(one.machine.step() for one in worn.cylinders.values())
    steps, sub = ticks(make, dt, duration, rng)
    rows = np.concatenate([[0.0], np.cumsum(steps[:-1]) * dt])
    even = np.linspace(0.0, rows[-1], len(rows))
    angles, still = gait(names, even, rng)
    angles = {name: np.interp(rows, even, values) for name, values in angles.items()}
    closed = np.interp(rows, even, still.astype(float))[::sub] > 0.5
    runs = {}
    for name, built in worn.cylinders.items():
        m = built.machine
        place = worn.seats[name].length(angles[name]) - m["lever_length"]
        speed = np.gradient(place, rows)
        led = np.column_stack([place, speed, np.gradient(speed, rows)])
        plan = _forces(built, angles[name][::sub], led[::sub, 1], closed, rng)
        y = np.zeros(STATES)
        p2 = m["ambient"] + 0.4 * (m["supply"] - m["ambient"])
        p1 = (p2 * m["area_2"] + m["ambient"] * (m["area_1"] - m["area_2"]) + plan.goal[0]) / m["area_1"]
        at_rest(y, place[0], p1, p2, m.packed()[0])
        own = gains(span_of(built), m.moved_mass, 0.3 / make.rate, 1e-5)
        own[5] = 0.0  # a force is wanted wherever the joint is
        one = advance(m, y, np.zeros(MEMO), Ticks(steps, sub, dt), plan, own, np.zeros(len(closed)), keep=True, led=led)
        if not np.isfinite(one.log["pressure_1"]).all() or place.min() < 0.0 or place.max() > m["stroke"]:
            raise TrialError(f"{name}: a drawn cylinder diverged or its piston met an end")
        runs[name] = one
    return Walk(runs, angles)


def _forces(built: Built, angle: Array, speed: Array, closed: NDArray[np.bool_], rng: np.random.Generator) -> Program:
    """Return what the valve of one cylinder does: follows a force that helps the joint along, fed forward with the speed."""
    span = span_of(built)
    swing = np.tanh(2.5 * (angle - np.median(angle)) / max(float(np.ptp(angle)), 0.1) * 2)
    goal = span.reach * (rng.uniform(0.1, 0.5) + rng.uniform(0.4, 0.9) * rng.choice([-1, 1]) * swing)
    feed = np.where(closed, 0.0, 0.7 * speed / built.full_speed)
    return Program(np.where(closed, FED, FORCES).astype(np.int64), goal, np.zeros(len(angle)), feed)


def _racks(worn: Worn, make: Make, rng: np.random.Generator) -> dict[str, Rack]:
    """Return the instruments of each cylinder: one card for all pressures, one for all angles and load cells."""
    first = next(iter(worn.cylinders.values())).machine
    force = 1.5 * first["supply"] * max(one.machine["area_1"] for one in worn.cylinders.values())
    arm = 0.08  # metres at the rod for a radian
    card = draw_rack(make.grade, rng, arm, force, first["ambient"], 101325.0)
    room = 101325.0 - first["ambient"] if make.grade.gauge else 0.0

    def own(channel: Any) -> Any:
        return replace(channel, offset=room + float(rng.normal(0, make.grade.offset)))

    return {name: replace(card, pressure_1=own(card.pressure_1), pressure_2=own(card.pressure_2)) for name in worn.cylinders}


def _case(
    name: str, cell: str, seed: int, make: Make, worn: Worn, walks: Sequence[Walk], unseen: Walk, weigh: bool, rng: np.random.Generator
) -> WornCase:
    racks = _racks(worn, make, rng)
    columns = ("command", "pressure_1", "pressure_2", "position", *(["force"] if worn.load_cells else []))
    supply = bool(rng.random() < 0.7)
    own, nearest, matter = {}, {}, {}
    wrong = float(np.clip(rng.standard_normal(), -2, 2))
    for joint, built in worn.cylinders.items():
        m, run = built.machine, walks[0].runs[joint]
        true = as_built(built)
        known = rig_effects(m, built.make, built.known, run)
        nearest[joint] = replace(true, effects=rig_effects(m, built.make, (*built.known, *built.hidden), run))
        own[joint] = replace(believed(built, true, known, rng), supply=true.supply * (1 + 0.01 * wrong))
        matter[joint] = matters(built, run, racks[joint], columns, built.hidden) if weigh else {}
    tables = tuple(_recorded(one, worn, racks, columns, supply, rng) for one in walks)
    fresh = _recorded(unseen, worn, racks, columns, supply, rng)
    shown_ = (*columns, *(["supply"] if supply else []))
    return WornCase(
        name, cell, seed, make, worn, racks, shown_, WornOwner(own, worn.seats), WornOwner(nearest, worn.seats), tables, fresh, matter
    )


def _recorded(one: Walk, worn: Worn, racks: Mapping[str, Rack], columns: Sequence[str], supply: bool,
              rng: np.random.Generator) -> dict[str, Array]:  # fmt: skip
    """Return the table of a recording."""
    table: dict[str, Array] = {}
    for joint, run in one.runs.items():
        rack, rate = racks[joint], worn.cylinders[joint].make.rate * run.ticks.sub
        table.setdefault("time [s]", run.time)
        table[f"{joint}.valve_command [1]"] = run.at_samples("command")
        signals = [("pressure_1", "Pa"), ("pressure_2", "Pa"), *([("force", "N")] if "force" in columns else [])]
        for signal, unit in signals:
            channel = getattr(rack, signal)
            table[f"{joint}.{signal} [{unit}]"] = shown(filtered(run.log[signal], channel, rate)[:: run.ticks.sub], channel, rng)
        table[f"{joint}.position [rad]"] = shown(filtered(one.angles[joint], rack.position, rate)[:: run.ticks.sub], rack.position, rng)
    if supply:
        run, rack = next(iter(one.runs.values())), next(iter(racks.values()))
        table["supply.pressure [Pa]"] = shown(run.at_samples("supply"), rack.supply, rng)
    return table


def truth_of(case: WornCase) -> dict[str, Any]:
    """Return what is true of a case, hidden things of all cylinders together."""
    cylinders = case.worn.cylinders
    there = {key for built in cylinders.values() for key in (*built.hidden, *built.known)}
    silent = set() if "force" in case.columns else {"coulomb_friction", "viscous_friction", "stribeck_friction"}
    columns: dict[str, Any] = {}
    for joint, rack in case.racks.items():
        columns |= {f"{joint}.pressure_1": rack.pressure_1.plain(), f"{joint}.pressure_2": rack.pressure_2.plain()}
        columns[f"{joint}.position"] = rack.position.plain()
        columns |= {f"{joint}.force": rack.force.plain()} if "force" in case.columns else {}
    if "supply" in case.columns:
        columns["supply.pressure"] = next(iter(case.racks.values())).supply.plain()
    return {
        "schema": "exo-sim/whole-truth/1",
        "case": case.name,
        "cell": case.cell,
        "make": case.make.name,
        "reported_only": case.make.reported,
        "seed": case.seed,
        "hidden": [entry for joint, built in cylinders.items() for entry in hidden_of(built, case.matter.get(joint) or {})],
        "known": sorted({BLOCKS[key].name or key for built in cylinders.values() for key in built.known}),
        "beside": sorted({*beside(sorted(there)), *silent}),
        "columns": columns,
        "machine": {joint: dict(built.machine.values) for joint, built in cylinders.items()},
        "believed": case.believed.plain(),
        "laws": laws_of(case.make),
    }


def write_worn_case(case: WornCase, folder: Path) -> None:
    """Write rig.toml, legs.xml, recording.csv, and what is true in the subfolder `truth`."""
    write_files(folder, case.believed, case.nearest, case.recordings, case.fresh, truth_of(case))
