"""One case of a whole machine: what its owner hands over, what is true, and a recording that nobody has seen."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import TrialError
from exo_sim.outputs import replacing
from exo_sim.trials.whole_machines.draw import Built, build
from exo_sim.trials.whole_machines.hidden_effects import BLOCKS, check_keys
from exo_sim.trials.whole_machines.instruments import Rack, draw_rack
from exo_sim.trials.whole_machines.machine_run import Run, drive, recorded
from exo_sim.trials.whole_machines.make import Make
from exo_sim.trials.whole_machines.makes import find
from exo_sim.trials.whole_machines.materiality import matters, plain
from exo_sim.trials.whole_machines.nearest_effects import rig_effects
from exo_sim.trials.whole_machines.owner_rig import Owner, as_built, believed

Array = NDArray[np.float64]
#: What every rig records; supply and load cell are there by chance.
ALWAYS = ("command", "pressure_1", "pressure_2", "position")
#: How often a machine is drawn anew that cannot be moved or diverges.
_TRIES = 12


@dataclass(frozen=True)
class WholeCase:
    """One case before it is written.

    Attributes:
        name, cell, seed: Which.
        built: As built.
        rack: Its instruments.
        columns: Signals that are recorded.
        believed: As its owner believes.
        nearest: The rig that comes nearest to the truth in the contract's words.
        recordings: Tables: column to values.
        fresh: A recording of the same machine that nobody has seen.
        matter: Block to what its absence changes.
    """

    name: str
    cell: str
    seed: int
    built: Built
    rack: Rack
    columns: tuple[str, ...]
    believed: Owner
    nearest: Owner
    recordings: tuple[Mapping[str, Array], ...]
    fresh: Mapping[str, Array]
    matter: Mapping[str, Mapping[str, float]]


def make_case(name: str, make: str, cell: str = "whole", seed: int = 0, *, effects: Sequence[str] = (), bulk: float = 1.0,
              duration: float = 20.0, recordings: int = 1, weigh: bool = True) -> WholeCase:  # fmt: skip
    """Draw a case.

    Args:
        name: Its name.
        make: Letter of `makes.MAKES`.
        cell: Of `draw.CELLS`.
        seed: Chance; the same seed gives the same case.
        effects: Keys of `hidden_effects.BLOCKS` that are hidden, instead of a draw.
        bulk: Factor on the sizes of what the machine has.
        duration: Length of a recording [s].
        recordings: How many.
        weigh: Whether to compute what each hidden effect matters (some ten seconds).

    Raises:
        TrialError: a make or effect is unknown, or no machine that moves was drawn.
    """
    kind = find(make)
    check_keys(effects)
    for attempt in range(_TRIES):
        rng = np.random.default_rng([seed, *map(ord, make), attempt, 20262])
        built = build(kind, cell, rng, effects, bulk)
        try:
            runs = [drive(built, _order(kind.programs, rng), duration, rng) for _ in range(recordings)]
            unseen = drive(built, kind.fresh, 0.6 * duration, rng)
        except TrialError:
            continue
        return instrumented(name, cell, seed, built, runs, unseen, weigh, rng)
    raise TrialError(f"make {make}, seed {seed}: {_TRIES} machines in a row diverged or were not moved; draw with another --seed")


def _order(names: tuple[str, ...], rng: np.random.Generator) -> tuple[str, ...]:
    return tuple(str(name) for name in rng.permutation(names))


def instrumented(
    name: str, cell: str, seed: int, built: Built, runs: Sequence[Run], unseen: Run, weigh: bool, rng: np.random.Generator
) -> WholeCase:
    """Return a case of a machine that was run: its instruments are drawn, and what its owner believes."""
    m, make = built.machine, built.make
    arm = 0.95 * m["lever_arm"] if m["lever"] else 1.0
    rack = draw_rack(make.grade, rng, arm, 1.5 * m["supply"] * m["area_1"], m["ambient"], 101325.0)
    columns = tuple(name for name in ALWAYS if name != "pressure_2" or not make.single)
    columns += (("supply",) if rng.random() < 0.7 or built.machine["tank_volume"] + built.machine["regulator_droop"] > 0 else ())
    columns += ("force",) if rng.random() < make.load_cell else ()
    true = as_built(built)
    known = rig_effects(m, make, built.known, runs[0])
    named = rig_effects(m, make, (*built.known, *built.hidden), runs[0])
    nearest = replace(true, dead_1=m["dead_1"], dead_2=m["dead_2"], effects=named)  # a hose that is named is not counted in as well
    own = believed(built, true, known, rng)
    tables = tuple(recorded(one, rack, built, columns, rng) for one in runs)
    fresh = recorded(unseen, rack, built, columns, rng)
    matter = matters(built, runs[0], rack, columns, built.hidden) if weigh else {}
    return WholeCase(name, cell, seed, built, rack, columns, own, nearest, tables, fresh, matter)


def hidden_of(built: Built, matter: Mapping[str, Mapping[str, float]]) -> list[dict[str, Any]]:
    """Return what a machine hides: names, places, parameters, and what each matters."""
    make, hidden = built.make, []
    for key in built.hidden:
        block = BLOCKS[key]
        exact = {
            name: {"value": value, "low": min(low, high), "high": max(low, high), "unit": block.units[name]}
            for name, (value, low, high) in block.exact(built.machine).items()
        }
        where = make.cylinder if block.place == "cylinder" else block.place
        also = [*block.also, *(["asymmetric_friction"] if key == "coulomb" and "asymmetry" in built.hidden else [])]
        hidden.append(
            {
                "name": block.name or key,
                "key": key,
                "where": where,
                "places": [where, make.joint, make.cylinder],
                "also": also,
                "family": block.family,
                "kind": "missing_physics" if block.name else "outside",
                "parameters": exact,
                "matters": plain(matter, key) if matter else None,
            }
        )
    return hidden


def beside(keys: Sequence[str]) -> list[str]:
    """Return names that may stand beside what a machine has, sorted."""
    return sorted({name for key in keys for name in BLOCKS[key].beside})


def truth_of(case: WholeCase) -> dict[str, Any]:
    """Return what is true of a case."""
    built, make = case.built, case.built.make
    rack = {name: getattr(case.rack, name).plain() for name in ("pressure_1", "pressure_2", "supply", "position", "force")}
    return {
        "schema": "exo-sim/whole-truth/1",
        "case": case.name,
        "cell": case.cell,
        "make": make.name,
        "reported_only": make.reported,
        "seed": case.seed,
        "hidden": hidden_of(built, case.matter),
        "known": [BLOCKS[key].name or key for key in built.known],
        "beside": beside((*built.hidden, *built.known)),
        "columns": {
            f"{make.cylinder}.pressure_1": rack["pressure_1"],
            **({f"{make.cylinder}.pressure_2": rack["pressure_2"]} if "pressure_2" in case.columns else {}),
            f"{make.joint}.position": rack["position"],
            **({f"{make.cylinder}.force": rack["force"]} if "force" in case.columns else {}),
            **({"supply.pressure": rack["supply"]} if "supply" in case.columns else {}),
        },
        "machine": dict(built.machine.values),
        "believed": case.believed.plain(),
        "laws": laws_of(make),
    }


def laws_of(make: Make) -> dict[str, Any]:
    """Return what a make's machines obey and how they are driven."""
    return {**vars(make.laws), "rate": make.rate, "build": make.build, "programs": list(make.programs), "fresh": list(make.fresh)}


def write_case(case: WholeCase, folder: Path) -> None:
    """Write rig.toml, bench.xml, recording.csv (or several), truth.json, nearest.toml and fresh.csv; see `write_files`."""
    write_files(folder, case.believed, case.nearest, case.recordings, case.fresh, truth_of(case))


class Written(Protocol):
    """What stands in rig.toml and its MJCF."""

    @property
    def model_file(self) -> str: ...

    def rig(self) -> str: ...

    def model(self) -> str: ...


def write_files(folder: Path, own: Written, nearest: Written, tables: Sequence[Mapping[str, Array]], fresh: Mapping[str, Array],
                truth: Mapping[str, Any]) -> None:  # fmt: skip
    """Write what an owner hands over to a folder, and what is true to its subfolder `truth`."""
    hidden = folder / "truth"
    hidden.mkdir(parents=True, exist_ok=True)
    for there, rig, file in ((folder, own, "rig.toml"), (hidden, nearest, "nearest.toml")):
        _text(there / file, rig.rig())
        _text(there / rig.model_file, rig.model())
    for i, table in enumerate(tables):
        stem = "recording" if len(tables) == 1 else f"recording_{i + 1}"
        _csv(folder / f"{stem}.csv", table)
    _csv(hidden / "fresh.csv", fresh)
    _text(hidden / "truth.json", json.dumps(truth, indent=1) + "\n")


def _text(path: Path, text: str) -> None:
    with replacing(path) as beside:
        beside.write_text(text)


def _csv(path: Path, table: Mapping[str, Array]) -> None:
    with replacing(path) as beside, beside.open("w") as out:
        out.write(",".join(table) + "\n")
        np.savetxt(out, np.column_stack(list(table.values())), fmt="%.9g", delimiter=",")
