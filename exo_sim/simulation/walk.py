"""What is asked of a simulation, and what comes back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from exo_sim.control import demand as law_of_demand
from exo_sim.control.force_signals import SIGNALS
from exo_sim.control.least_load import Weights
from exo_sim.control.valve_control import CONTROLLERS, ValveGains
from exo_sim.errors import ScenarioError, nearest
from exo_sim.gait import scenario as scenarios
from exo_sim.gait.motion import Motion
from exo_sim.gait.scenario_record import WEARERS, Scenario
from exo_sim.gait.variation import Variation
from exo_sim.machine.person import COORDINATES, SEGMENTS, Person
from exo_sim.machine.straps import StrapSet
from exo_sim.physics.pneumatics import Books
from exo_sim.rig import Rig
from exo_sim.simulation.wearer_log import Moved

ASSIST = ("on", "off", "vented")
DRIVEN = ("", "valves", "torques")
JOINTS = COORDINATES[3:]
#: Parts of the body that straps hold, in the order of the ledger.
STRAPPED = ("torso", "thigh", "shoe")
#: What works on the machine, as the loop logs it: ground, damping and friction, springs, cylinders and motors, straps.
POWERS = ("ground", "damping", "spring", "actuator", *(f"{part}_strap" for part in STRAPPED))


@dataclass(frozen=True)
class Request:
    """What to simulate.

    Attributes:
        scenario: Its name.
        payload: On the back [kg].
        speed: Factor on the recorded cadence, or the speed of walking like "1.3 m/s".
        cycles: How many strides or repetitions; None for the scenario's own number.
        assist: "on"; "off": valves closed, gas trapped; "vented": both chambers open to the atmosphere.
        controller: How valves get forces, one of `CONTROLLERS`; where commands come from outside, what to call whoever gives them.
        law: What is demanded, one of `control.demand.LAWS`.
        rehearsals: How often the least-load demand is bettered before the run, at the most, and where a payload is put on the way as often
            for it. Fewer than two are walked with the plan alone (`control.least_load`).
        weights: What counts in the least-load demand; None for its own, or those of `load_weights` from rest, for a wearer who is
            a body, and where chambers are planned.
        gains: Of the valve controllers.
        tuned: Gains of single cylinders, by name, in place of `gains`; the demand is read ahead as `gains` says for all.
        signals: What the valve controllers go by, one of `force_signals.SIGNALS`: what is, or what gauges and encoders show.
        ideal: Forces come as demanded, without gas.
        step: Of the simulation [s]; None for the MJCF's own.
        given: The scenario itself, where it is not to be found by its name: `scenario` then is what to call it.
        variation: How strides differ from the mean one; None for what the scenario says.
        wearer: What moves the wearer: "prescribed", he follows the reference whatever happens; "torques", he is a body that yields; or
            None for what the scenario says.
        driven: What comes from outside, step by step: "valves" (their commands), "torques" (of the joints), or "" where nothing does.

    Raises:
        ScenarioError: a name that does not exist or a number out of range.
    """

    scenario: str
    payload: float = 34.0
    speed: float | str = 1.0
    cycles: int | None = None
    assist: str = "on"
    controller: str = "model"
    law: str = law_of_demand.DEFAULT_LAW
    rehearsals: int = 48
    weights: Weights | None = None
    gains: ValveGains = field(default_factory=ValveGains)
    tuned: Mapping[str, ValveGains] = field(default_factory=dict)
    signals: str = "exact"
    ideal: bool = False
    step: float | None = None
    given: Scenario | None = None
    wearer: str | None = None
    driven: str = ""
    variation: Variation | None = None

    def __post_init__(self) -> None:
        _ = self.found
        for name, value, choices in (
            ("assist", self.assist, ASSIST),
            ("controller", self.controller, (*CONTROLLERS, *([self.controller] if self.driven else []))),
            ("law", self.law, law_of_demand.LAWS),
            ("driven", self.driven, DRIVEN),
            ("wearer", self.moved_by, WEARERS),
            ("signals", self.signals, SIGNALS),
        ):
            if value not in choices:
                raise ScenarioError(f'{name} "{value}"{nearest(value, choices)}')
        if self.driven and self.assist != "on":
            raise ScenarioError(f'assist "{self.assist}" holds the valves itself; a controller of your own needs assist "on"')
        if self.cycles is not None and not (1 <= self.cycles <= 10000 and self.cycles == int(self.cycles)):
            raise ScenarioError(f"{self.cycles} cycles: ask for 1 to 10000, whole ones")

    @property
    def moved_by(self) -> str:
        """What moves the wearer, one of `WEARERS`."""
        return self.wearer if self.wearer is not None else self.found.wearer

    @property
    def found(self) -> Scenario:
        """The scenario that was given or is called so."""
        return self.given if self.given is not None else scenarios.find(self.scenario)


@dataclass(frozen=True)
class Walk:
    """What was simulated, or a piece of it.

    Attributes:
        request: What was asked for.
        rig: The machine.
        person: Who wore it.
        motion: What the wearer does: the reference, with trunk and pelvis as wearer and machine together need them.
        plain: The reference as recorded or drawn.
        straps: Between them.
        time: [s], shape (n,).
        columns: `"<part>.<signal>"` to values in SI, shape (n,).
        units: The same keys to SI units.
        poses: The person's segments at each row, shape (n, 7, 6).
        wrench: What the straps do to each of them, shape (n, 7, 3).
        weight: Of frame and payload at each row [N], shape (n,).
        payload: On the back at each row [kg], shape (n,).
        books: Of the gas, or None where there is none.
        step: Of the simulation [s].
        interrupted: True where it was stopped early.
        model: The MuJoCo model, for drawing.
        moved: What a torque-driven wearer did; None for one whose motion is prescribed.
        first: Which row of the whole run the first one is.
    """

    request: Request
    rig: Rig
    person: Person
    motion: Motion
    plain: Motion
    straps: StrapSet
    time: NDArray[np.float64]
    columns: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    poses: NDArray[np.float64]
    wrench: NDArray[np.float64]
    weight: NDArray[np.float64]
    payload: NDArray[np.float64]
    books: Books | None
    step: float
    interrupted: bool
    model: mujoco.MjModel
    moved: Moved | None = None
    first: int = 0

    def part(self, rows: slice) -> Walk:
        """Return some rows of it, which follow each other; the books stay those of all."""
        first = range(len(self.time))[rows].start
        return replace(
            self,
            time=self.time[rows],
            columns={key: values[rows] for key, values in self.columns.items()},
            poses=self.poses[rows],
            wrench=self.wrench[rows],
            weight=self.weight[rows],
            payload=self.payload[rows],
            moved=None if self.moved is None else self.moved.at(rows),
            first=self.first + first,
        )


def layout(rig: Rig, straps: StrapSet, gas: bool) -> list[tuple[str, str]]:
    """Return key and unit of every number that the loop logs behind the time, in its order."""
    names = ("torso_x", "torso_z", *COORDINATES[2:])
    kind = ["m", "m", *["rad"] * 7]
    out = [(f"{name}.position", unit) for name, unit in zip(names, kind)]
    out += [(f"{name}.velocity", f"{unit}/s") for name, unit in zip(names, kind)]
    out += [(f"{name}.torque", "N*m") for name in JOINTS] + [(f"{name}.torque_demanded", "N*m") for name in JOINTS]
    out += [(f"{name}.strap_force_{axis}", "N") for name in straps.names for axis in "xz"]
    out += [(f"foot_{side}.ground_force_{axis}", "N") for side in "lr" for axis in "xz"]
    out += [(f"foot_{side}.pressure_centre", "m") for side in "lr"]
    out += [("gait.phase", "1"), ("gait.stance_l", "1"), ("gait.stance_r", "1")]
    out += [(f"ledger.{name}_power", "W") for name in POWERS]
    out += [(f"wearer.{segment}_{axis}", "1") for segment in SEGMENTS for axis in ("x", "z", "moment")]
    for name in rig.cylinders:
        out += [(f"{name}.force_demanded", "N"), (f"{name}.force", "N"), (f"{name}.length", "m")]
    if gas:
        for name, cylinder in rig.cylinders.items():
            out += [(f"{name}.{command}", "1") for command in cylinder.commands]
            out += [(f"{name}.pressure_1", "Pa"), (f"{name}.pressure_2", "Pa")]
            out += [(f"{name}.temperature_1", "K"), (f"{name}.temperature_2", "K")]
            out += [(f"{name}.choked", "1"), (f"{name}.gas_used", "kg")]
        out += [("supply.pressure", "Pa"), ("exhaust.pressure", "Pa")]
        if rig.recovery is not None:
            out += [("recovery.pressure", "Pa"), ("recovery.gas", "kg")]
    return out


def as_columns(
    log: NDArray[np.float64], keys: list[tuple[str, str]]
) -> tuple[dict[str, NDArray[np.float64]], dict[str, str], NDArray[np.float64]]:
    """Return the columns of a log by name, their units, and what the straps do to the wearer's segments, shape (n, 7, 3).

    Args:
        log: Rows as the loop writes them, the time first, shape (n, 1 + len(keys)).
        keys: As `layout` returns them.
    """
    table = _turned(log[:, 1:])
    columns = {key: table[i] for i, (key, _) in enumerate(keys)}
    wrench = np.stack([columns.pop(key) for key, _ in keys if key.startswith("wearer.")], axis=1)
    units = {key: unit for key, unit in keys if key in columns}
    return columns, units, wrench.reshape(len(log), len(SEGMENTS), 3)


def _turned(log: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a copy of rows as columns, each in one piece, shape (m, n); some hundred rows at a time stay in the cache."""
    out = np.empty(log.shape[::-1])
    for start in range(0, len(log), 128):
        out[:, start : start + 128] = log[start : start + 128].T
    return out


def rig_at_250_psi() -> Path:
    """Return the rig of the worn machine at the pressure of the paper, above what its cylinders are rated for; its frame carries none."""
    return default_rig().with_name("exo_250_psi.toml")


def default_rig() -> Path:
    """Return the rig of the worn machine that comes with the package."""
    return Path(__file__).resolve().parents[1] / "assets" / "exo.toml"
