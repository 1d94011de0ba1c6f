"""One case of the proving ground: a bench, what is hidden in it, and the files its owner would hand over."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.trials.conditions import ALL_KNOWN, Conditions
from exo_sim.trials.hidden_effects import Effect, Hidden, find, plant
from exo_sim.trials.leg_cases import LegCase
from exo_sim.trials.truth.bench import CYLINDER, JOINT, Bench, believed, draw_bench
from exo_sim.trials.truth.drive import Truth, drive
from exo_sim.trials.truth.instruments import Instrument, measure
from exo_sim.trials.truth.machine import Machine

Array = NDArray[np.float64]
#: What every healthy bench has a trace of, drawn where "mild oddities" are asked for.
HEALTHY = (
    "wall_heat_transfer",
    "piston_leakage",
    "external_leakage",
    "external_leakage:chamber_2",
    "valve_null_leakage",
    "valve_deadband",
    "valve_offset",
    "valve_hysteresis",
    "critical_ratio",
    "curved_valve",
    "unequal_paths",
    "coulomb_friction",
    "viscous_friction",
    "return_spring",
    "cogging",
)
#: Column to its name in the truth's log.
COLUMNS = {
    f"{CYLINDER}.valve_command [1]": "command",
    f"{CYLINDER}.pressure_1 [Pa]": "pressure_1",
    f"{CYLINDER}.pressure_2 [Pa]": "pressure_2",
    f"{JOINT}.position [m]": "position",
    "supply.pressure [Pa]": "supply",
    "exhaust.pressure [Pa]": "exhaust",
}


@dataclass(frozen=True)
class Case:
    """One case before it is written.

    Attributes:
        name: Folder name.
        bench: As built.
        believed: As its owner believes.
        machine: As built, hidden things included.
        hidden: What is hidden.
        truth: One per recording.
        recordings: One table per recording: column to values, `time [s]` first.
        about: Everything else worth keeping: seed, program, cell.
        pressure, position: The instruments, before sensor effects.
    """

    name: str
    bench: Bench
    believed: Bench
    machine: Machine
    hidden: tuple[Hidden, ...]
    truth: tuple[Truth, ...]
    recordings: tuple[dict[str, Array], ...]
    about: Mapping[str, object] = field(default_factory=dict)
    pressure: Instrument = field(default_factory=Instrument)
    position: Instrument = field(default_factory=Instrument)

    @property
    def at_valve(self) -> bool:
        """Whether the pressure sensors sit at the valve end of the hoses."""
        return any(entry.parameters.get("sensor_at_valve", 0) for entry in self.hidden)


def make_case(
    name: str,
    effects: Sequence[str] = (),
    seed: int = 0,
    size: float | Sequence[float] = 1.0,
    conditions: Conditions | None = None,
    keep_states: bool = False,
) -> Case:
    """Draw a case.

    Args:
        name: Its name.
        effects: Keys of `hidden_effects.EFFECTS`.
        seed: Seed of the random numbers; the same seed gives the same case.
        size: Size of every effect, or one each; 1 is clearly visible.
        conditions: Under what it is recorded; those of a good laboratory when absent.
        keep_states: Keep the full true state at every sample, which `detection_limit.distance` needs.

    Raises:
        TrialError: an effect is unknown, or the drawn machine diverged.
    """
    under = conditions or Conditions()
    rng = np.random.default_rng([seed, 20260])
    wanted = [find(key) for key in effects]
    owner_knows = _owner_knows(wanted, under.known, rng)
    bench = draw_bench(rng, owner_knows)
    sizes = [float(size)] * len(wanted) if isinstance(size, int | float) else [float(s) for s in size]
    hidden = tuple(plant(effect, bench, s, seed * 31 + i) for i, (effect, s) in enumerate(zip(wanted, sizes)))
    machine = _with_oddities(bench, seed, rng) if under.oddities else bench.machine()
    for entry in hidden:
        machine = entry.into(machine, bench)
    own = believed(bench, rng, 0.02 * under.errors, 0.05 * under.errors, 0.005 * under.errors, 0.01 * under.errors)
    reach = max([0.7] + [effect.reach for effect in wanted])
    truths = tuple(
        drive(bench, machine, under.program, under.duration, under.rate, under.jitter, reach, rng, keep_states)
        for _ in range(under.recordings)
    )
    pressure, position = _instruments(under)
    about = {
        "seed": seed,
        "program": under.program,
        "known": list(owner_knows),
        "recordings": under.recordings,
        "oddities": under.oddities,
    }
    case = Case(name, bench, own, machine, hidden, truths, (), about, pressure, position)
    return replace(case, recordings=tuple(_measured(case, truth, under, rng) for truth in truths))


def _owner_knows(wanted: Sequence[Effect], known: Sequence[str] | None, rng: np.random.Generator) -> tuple[str, ...]:
    """Return what the owner has in the rig: what is known or needed, but never what is hidden."""
    needs = {need for effect in wanted for need in effect.known}
    if known is None:
        known = ALL_KNOWN if rng.random() < 0.5 else ()
    hidden = {effect.name for effect in wanted}
    if "asymmetric_friction" in hidden and "coulomb_friction" not in needs:
        hidden |= {"coulomb_friction"}
    return tuple(key for key in ALL_KNOWN if (key in known or key in needs) and key not in hidden)


def _with_oddities(bench: Bench, seed: int, rng: np.random.Generator) -> Machine:
    """Return the machine with what every healthy bench has a trace of."""
    machine = bench.machine().with_(spool_frequency=rng.uniform(110, 160), spool_damping=0.8)
    if machine["heat_conductance"] > 0:
        machine = machine.with_(heat_eichelberg=rng.uniform(0.05, 0.15))
    for i, key in enumerate(HEALTHY):
        effect = find(key)
        trace = plant(effect, bench, effect.healthy * min(abs(rng.standard_normal()), 2.5), seed * 31 + 1000 + i)
        fields = effect.fields(bench, trace.parameters)
        machine = machine.with_(**{name: value for name, value in fields.items() if machine.is_default(name)})
    return machine


def _instruments(under: Conditions) -> tuple[Instrument, Instrument]:
    """Return the instruments of pressures and position."""
    sensors = under.sensors
    correlated = max(sensors.correlated, 0.5) if under.oddities else sensors.correlated
    pressure = Instrument(
        noise=sensors.pressure_noise,
        slow_noise=correlated * sensors.pressure_noise,
        bits=sensors.bits,
        low=0.0,
        high=1.2e6,
        lag=sensors.lag,
        drift=sensors.drift,
    )
    position = Instrument(
        noise=sensors.position_noise,
        slow_noise=correlated * sensors.position_noise,
        bits=sensors.bits,
        low=-0.3,
        high=0.3,
        lag=sensors.lag,
        delay=sensors.skew,
    )
    return pressure, position


def _measured(case: Case, truth: Truth, under: Conditions, rng: np.random.Generator) -> dict[str, Array]:
    """Return one recording as its table."""
    table = {"time [s]": truth.log["time"]}
    for column, key in COLUMNS.items():
        absent = {"supply": not under.supply_recorded, "exhaust": not under.exhaust_recorded}.get(key, False)
        if absent or column.split(" ")[0] in under.missing:
            continue
        if key == "command":
            table[column] = truth.log[key]
            continue
        if case.at_valve and key in ("pressure_1", "pressure_2"):
            key = "line" + key[-2:]
        true = truth.log[key] - case.bench.zero if key == "position" else truth.log[key]
        table[column] = measure(truth.log["time"], true, instrument_of(case, column), rng)
    return table


def instrument_of(case: Case, column: str) -> Instrument:
    """Return the instrument of a column, with the sensor effects that are planted in it."""
    column = column.split(" ")[0]
    instrument = case.position if column.endswith(".position") else case.pressure
    for entry in case.hidden:
        if entry.effect.where != column:
            continue
        p = entry.parameters
        if "seconds" in p:
            instrument = replace(instrument, delay=instrument.delay + p["seconds"])
        if "value" in p:
            instrument = replace(
                instrument, bias=p["value"], low=instrument.low - 2e5 if instrument.low == 0 else instrument.low
            )
        if "factor" in p:
            instrument = replace(instrument, scale=p["factor"])
    return instrument


def truth_of(case: Case | LegCase) -> dict[str, Any]:
    """Return what is sealed: hidden effects with parameters, the machine as built and as believed."""
    return {
        "schema": "exo-sim/truth/1",
        "case": case.name,
        "hidden": [
            {
                "name": entry.effect.name,
                "variant": entry.effect.variant,
                "where": entry.effect.where,
                "also": list(entry.effect.synonyms),
                "kind": entry.effect.kind,
                "size": entry.size,
                "parameters": {
                    key: {"value": float(value), "unit": entry.effect.units.get(key, "1")}
                    for key, value in entry.parameters.items()
                },
            }
            for entry in case.hidden
        ],
        "about": dict(case.about),
        "bench": case.bench.plain(),
        "believed": case.believed.plain(),
    }


def write_case(case: Case | LegCase, folder: Path, fmt: str = "csv", open_truth: bool = False) -> list[Path]:
    """Write rig.toml, the MJCF and the recordings, and with `open_truth` truth.json; return the recordings' paths."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "rig.toml").write_text(case.believed.rig())
    (folder / case.believed.model_file).write_text(case.believed.model())
    paths = []
    for i, table in enumerate(case.recordings):
        stem = "recording" if len(case.recordings) == 1 else f"recording_{i + 1}"
        path = folder / f"{stem}.{fmt}"
        if fmt == "parquet":
            import pyarrow as pa
            import pyarrow.parquet as pq

            pq.write_table(pa.table(table), path)
        else:
            write_csv(table, path)
        paths.append(path)
    if open_truth:
        (folder / "truth.json").write_text(json.dumps(truth_of(case), indent=1))
    return paths


def write_csv(table: Mapping[str, Array], path: Path) -> None:
    """Write columns as CSV with the names as header, nine digits."""
    values = np.column_stack(list(table.values()))
    with path.open("w") as out:
        out.write(",".join(table) + "\n")
        np.savetxt(out, values, fmt="%.9g", delimiter=",")
