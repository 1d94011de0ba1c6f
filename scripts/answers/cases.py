"""The fixed set of cases: what is made, from which seed, and how it is written."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import zip_longest
from pathlib import Path

from exo_sim.recording import Recording, read, write_table
from exo_sim.trials.cases import Case, make_case, write_case
from exo_sim.trials.conditions import ALL_KNOWN, Conditions, LegConditions, Sensors
from exo_sim.trials.hidden_effects import EFFECTS
from exo_sim.trials.leg_cases import make_leg_case

#: Length of a recording [s]: with 1000 samples a second long enough that fits are not counted as cheap.
SECONDS = 5.5
BENCH = Conditions(duration=SECONDS, known=())


@dataclass(frozen=True)
class Bench:
    """A bench of the proving ground."""

    effects: tuple[str, ...] = ()
    conditions: Conditions = BENCH
    seed: int = 11
    change: Callable[[Case], Case] = lambda case: case

    def write(self, name: str, folder: Path, repository: Path) -> None:
        write_case(self.change(make_case(name, self.effects, self.seed, conditions=self.conditions)), folder)


@dataclass(frozen=True)
class Leg:
    """A walking leg."""

    effects: tuple[str, ...]
    seed: int = 5

    def write(self, name: str, folder: Path, repository: Path) -> None:
        write_case(make_leg_case(name, self.effects, self.seed, conditions=LegConditions(duration=4.0, known=())), folder)


@dataclass(frozen=True)
class Real:
    """Recordings of a real machine: tables of `scripts/real_recordings` and a rig in assets/real, or a folder that holds both.

    Attributes:
        machine: Its folder, of assets/real or, with a slash, of ../shared/data.
        files: Pattern of its recordings.
        most: Rows of each recording that are kept, from its beginning.
    """

    machine: str
    files: str
    most: int = 6000

    def write(self, name: str, folder: Path, repository: Path) -> None:
        ours = repository / "assets" / "real" / self.machine
        source = ours if ours.is_dir() else data(repository) / self.machine
        tables = _converted(repository) / self.machine if ours.is_dir() else source
        for path in [*source.glob("*.toml"), *source.glob("*.xml")]:
            shutil.copy(path, folder / path.name)
        found = sorted(tables.glob(self.files))
        if not found:
            raise SystemExit(f"same_answers: {tables} holds no {self.files}")
        for path in found:
            table: Recording = read(path).recording
            kept = {key: values[: self.most] for key, values in table.columns.items()}
            write_table(folder / f"recording_{path.stem}.parquet", replace(table, time=table.time[: self.most], columns=kept))


def data(repository: Path) -> Path:
    """Return the folder of real recordings, present or not."""
    return repository.parent / "shared" / "data"


@cache
def _converted(repository: Path) -> Path:
    """Return a folder with the contract's tables of the real recordings; the operating system clears it."""
    out = Path(tempfile.mkdtemp(prefix="same_answers_"))
    words = [sys.executable, str(repository / "scripts" / "real_recordings"), str(out), str(data(repository))]
    subprocess.run(words, check=True, capture_output=True)
    return out


def _command_turned_round(case: Case) -> Case:
    (table,) = case.recordings
    key = "piston.valve_command [1]"
    return replace(case, recordings=({**table, key: -table[key]},))


def _with_a_jump_of_the_clock(case: Case) -> Case:
    (table,) = case.recordings
    key = "time [s]"
    return replace(case, recordings=({**table, key: table[key] + 0.7 * (table[key] > 2.0)},))


def _stuck(case: Case) -> Case:
    (table,) = case.recordings
    key = "piston.pressure_1 [Pa]"
    values = table[key].copy()
    values[2000:3000] = values[2000]
    return replace(case, recordings=({**table, key: values},))


PAIRS = (
    "wall_heat_transfer+piston_leakage", "valve_deadband+valve_lag", "coulomb_friction+viscous_friction", "line_restriction+critical_ratio",
    "transmission_compliance+viscous_friction", "supply_droop+supply_regulator", "external_leakage+coulomb_friction",
    "asymmetric_friction+return_spring", "dead_volume+wall_heat_transfer", "relief_valve+coulomb_friction",
)  # fmt: skip
LEGS = {
    "leg_piston_leakage": Leg(("piston_leakage",)),
    "leg_hose_at_valve": Leg(("line_restriction:valve_end",)),
    "leg_sensor_delay": Leg(("sensor_delay",)),
    "leg_coulomb_friction": Leg(("coulomb_friction",)),
    "leg_two": Leg(("wall_heat_transfer", "viscous_friction"), 7),
}
SPECIAL = {
    "nothing": Bench(),
    "nothing_with_oddities": Bench(conditions=replace(BENCH, oddities=True), seed=3),
    "nothing_owner_knows_all": Bench(conditions=replace(BENCH, known=None), seed=4),
    "owner_knows_heat_and_friction": Bench(("piston_leakage",), replace(BENCH, known=ALL_KNOWN)),
    "longer_heat": Bench(("wall_heat_transfer",), replace(BENCH, duration=12.0)),
    "longer_nothing": Bench(conditions=replace(BENCH, duration=12.0), seed=12),
    "longer_drag": Bench(("quadratic_drag",), replace(BENCH, duration=12.0)),
    "few_samples": Bench(("valve_offset",), replace(BENCH, rate=250.0, duration=10.0)),
    "few_samples_two": Bench(("external_leakage", "viscous_friction"), replace(BENCH, rate=200.0, duration=12.0)),
    "slow_clock": Bench(("coulomb_friction",), replace(BENCH, rate=20.0, duration=40.0)),
    "two_recordings": Bench(("wall_heat_transfer",), replace(BENCH, recordings=2, duration=4.0)),
    "three_recordings": Bench(("coulomb_friction", "piston_leakage"), replace(BENCH, recordings=3, duration=3.0)),
    "no_supply": Bench(("supply_droop",), replace(BENCH, supply_recorded=False)),
    "no_supply_leak": Bench(("piston_leakage",), replace(BENCH, supply_recorded=False)),
    "exhaust_recorded": Bench(("exhaust_back_pressure",), replace(BENCH, exhaust_recorded=True)),
    "no_pressure_1": Bench(("viscous_friction",), replace(BENCH, missing=("piston.pressure_1",))),
    "no_pressure_2": Bench(("coulomb_friction",), replace(BENCH, missing=("piston.pressure_2",))),
    "no_pressure_2_leak": Bench(("external_leakage:chamber_2",), replace(BENCH, missing=("piston.pressure_2",))),
    "no_pressures": Bench(("coulomb_friction",), replace(BENCH, missing=("piston.pressure_1", "piston.pressure_2"))),
    "no_position": Bench(("piston_leakage",), replace(BENCH, missing=("slide.position",))),
    "no_command": Bench(("piston_leakage",), replace(BENCH, missing=("piston.valve_command",))),
    "command_turned_round": Bench(("valve_lag",), change=_command_turned_round),
    "jump_of_the_clock": Bench(("wall_heat_transfer",), change=_with_a_jump_of_the_clock),
    "stuck_sensor": Bench(("viscous_friction",), change=_stuck),
    "jitter_and_skew": Bench(("piston_leakage",), replace(BENCH, jitter=1e-4, sensors=Sensors(skew=1e-3))),
    "holds": Bench(("external_leakage:porous",), replace(BENCH, program="holds")),
    "tracking": Bench(("stribeck_friction",), replace(BENCH, program="tracking")),
}
REAL = {
    "real_emps": Real("emps", "*.parquet"),
    "real_pendulum": Real("pendulum", "*.parquet"),
    "real_gas_spring": Real("gas_spring", "*.parquet", 3000),
    "real_o_ring": Real("seals_friction", "O-ring*.parquet", 2000),
    "real_kdn": Real("seals_friction", "KDN*.parquet", 2000),
    "real_decay_aluminium": Real("pressure_decay", "Aluminium*.parquet"),
    "real_decay_ultimaker": Real("pressure_decay", "Ultimaker*.parquet"),
    "real_seal_napn": Real("unkind/seal_napn", "recording*.csv", 2000),
    "real_seal_pk": Real("unkind/seal_pk", "recording*.csv", 2000),
    "real_spring_moving": Real("unkind/spring_moving", "recording*.csv", 500),
    "real_spring_vented": Real("unkind/spring_vented", "recording*.csv", 500),
    "real_upright": Real("unkind/upright", "recording*.csv", 2000),
}


def kinds() -> tuple[dict[str, Bench | Leg | Real], ...]:
    """Return all cases by name, a dictionary for each kind: one effect, two, walking legs, sensors and clocks, real machines."""
    alone: dict[str, Bench | Leg | Real] = {key.replace(":", "-"): Bench((key,)) for key in EFFECTS}
    pairs: dict[str, Bench | Leg | Real] = {pair: Bench(tuple(pair.split("+"))) for pair in PAIRS}
    return alone, pairs, dict(LEGS), dict(SPECIAL), dict(REAL)


def _every() -> dict[str, Bench | Leg | Real]:
    """Return all cases by name, of each kind one in turn: whoever stops early has seen some of all."""
    turns = zip_longest(*(kind.items() for kind in kinds()))
    return {name: case for turn in turns for name, case in filter(None, turn)}


def names(repository: Path) -> list[str]:
    """Return the names of all cases that can be made here."""
    return [name for name, case in _every().items() if not isinstance(case, Real) or data(repository).is_dir()]


def make(name: str, folder: Path, repository: Path) -> bool:
    """Write a case into its folder, unless it stands there already; return whether it had to be written."""
    if folder.exists():
        return False
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as beside:
        made = Path(beside) / name
        made.mkdir()
        _every()[name].write(name, made, repository)
        made.rename(folder)
    return True
