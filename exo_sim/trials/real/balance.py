"""The force that a rig says must act from outside, against the force that was recorded: an own reading of rig files, one slide.

With the motion, the pressures and the outside force measured, nothing has to be simulated: m a = F_out + F_rod - m g - R, where F_rod is
P1 A1 - P2 A2 - P_atm A_rod and R is friction and springs as the contract defines them (formats: names of effects; breakaway is the
whole dry force at rest, pressure-dependent friction counts gauge pressures of both chambers). This shares no code with the simulator.
"""

from __future__ import annotations

import math
import tomllib
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from exo_sim import units
from exo_sim.recording import Recording
from exo_sim.trials.real.case import Moving

Array = NDArray[np.float64]

_ATMOSPHERE = "101325 Pa"
#: What acts on gas, command or supply alone, and cannot change a force where pressures are measured.
_OF_THE_GAS = frozenset((
    "wall_heat_transfer", "moving_wall_temperature", "piston_leakage", "external_leakage", "valve_null_leakage", "valve_deadband",
    "valve_offset", "valve_lag", "valve_hysteresis", "spool_rate_limit", "line_restriction", "exhaust_back_pressure", "supply_droop",
    "supply_regulator", "critical_ratio", "end_cushioning",
))  # fmt: skip
#: What shows in the motion alone.
_OF_THE_MOTION = frozenset(("transmission_compliance", "backlash"))


@dataclass(frozen=True)
class Rows:
    """Rows of a recording at which its part moves.

    Attributes:
        position, velocity, acceleration, outside: Of the slide, + outwards [m, m/s, m/s^2, N], shape (n,).
        pressure_1, pressure_2: Absolute [Pa]; NaN where there is no cylinder.
        travelled: Since the motion last turned round [m].
    """

    position: Array
    velocity: Array
    acceleration: Array
    outside: Array
    pressure_1: Array
    pressure_2: Array
    travelled: Array


@dataclass(frozen=True)
class Machine:
    """Numbers of a rig that a balance of forces needs, SI.

    Attributes:
        mass: Of the carriage and what it carries.
        weight: Gravity's pull towards smaller positions [N].
        area_1, area_2: Of the piston; 0 where there is no cylinder.
        single: Chamber 2 is open to the room.
        ambient: The room's pressure.
        damping, friction: Of the MJCF's joint.
        effects: (name, where, table).
        left_out: Effects that this reading does not know; their force is taken as zero.
    """

    mass: float
    weight: float
    area_1: float
    area_2: float
    single: bool
    ambient: float
    damping: float
    friction: float
    effects: tuple[tuple[str, str, Mapping[str, Any]], ...]
    left_out: tuple[str, ...]


def read_machine(path: Path) -> Machine:
    """Read a rig of one slide and at most one cylinder, and its MJCF."""
    rig = tomllib.loads(path.read_text(encoding="utf-8"))
    model = ElementTree.parse(path.parent / rig["model"]).getroot()
    body = next(body for body in model.iter("body") if body.find("joint") is not None)
    joint = body.find("joint")
    assert joint is not None
    mass = sum(float(part.get("mass", 0.0)) for part in (*body.iter("geom"), *body.iter("inertial")))
    said = rig.get("bodies", {}).get(body.get("name"), {}).get("mass")
    mass = units.parse(said, "kg") if said is not None else mass
    option = model.find("option")
    pull = np.array([float(x) for x in (option.get("gravity", "0 0 -9.81") if option is not None else "0 0 -9.81").split()])
    axis = np.array([float(x) for x in joint.get("axis", "0 0 1").split()])
    factor = float(rig.get("joints", {}).get(joint.get("name"), {}).get("damping_factor", 1.0))
    effects = tuple(
        (name, where, table)
        for name, places in rig.get("effects", {}).items()
        for where, table in places.items()
        if isinstance(table, dict)
    )
    cylinder: Mapping[str, Any] = next(iter(rig.get("cylinders", {}).values()), {})
    bore, rod = (units.parse(cylinder.get(key, "0 m"), "m") for key in ("bore", "rod"))
    known = _OF_THE_GAS | _OF_THE_MOTION | _LAWS.keys() | {"sensor_delay", "sensor_scale", "sensor_bias", "unknown"}
    return Machine(
        mass=mass,
        weight=-mass * float(pull @ axis) / float(np.linalg.norm(axis)),
        area_1=0.25 * math.pi * bore**2,
        area_2=0.25 * math.pi * (bore**2 - rod**2),
        single=cylinder.get("acting", "double") == "single",
        ambient=units.parse(rig.get("environment", {}).get("pressure", _ATMOSPHERE), "Pa"),
        damping=factor * float(joint.get("damping", 0.0)),
        friction=float(joint.get("frictionloss", 0.0)),
        effects=effects,
        left_out=tuple(sorted({name for name, _, _ in effects} - known)),
    )


def rows(recording: Recording, moving: Moving, machine: Machine) -> Rows:
    """Return the rows at which the slide moves, sensors put right as the rig has them, all behind one low-pass.

    Args:
        recording: With `.position`, `.external_force` where there is one, and pressures where there is a cylinder.
        moving: Which rows.
        machine: Of which the sensor effects are taken off.
    """
    clock = recording.time
    step = float(np.median(np.diff(clock)))
    time = np.arange(clock[0], clock[-1], step)
    low_pass = butter(2, min(moving.cut_off * 2 * step, 0.9), output="sos")

    def signal(ending: str) -> Array:
        column = next((name for name in recording.columns if name.endswith(ending)), None)
        if column is None:
            return np.full(len(time), np.nan)
        values, late = _put_right(recording[column], column, machine)
        there = np.isfinite(values)
        smooth: Array = sosfiltfilt(low_pass, np.interp(time + late, clock[there], values[there]))
        return smooth

    position = signal(".position")
    velocity = np.gradient(position, step)
    acceleration = np.gradient(velocity, step)
    outside = np.nan_to_num(signal(".external_force"), nan=0.0)
    gap = np.interp(time, clock, np.maximum(np.append(np.diff(clock), step), np.insert(np.diff(clock), 0, step)))
    keep = (np.abs(velocity) > moving.speed) & (np.abs(acceleration) < moving.acceleration) & (gap < 5 * step)
    edge = int(0.5 / moving.cut_off / step) + 1
    keep[:edge] = keep[-edge:] = False
    turns = np.concatenate([[0], np.flatnonzero(np.diff(np.sign(velocity))) + 1])
    travelled = np.abs(position - position[turns[np.searchsorted(turns, np.arange(len(time)), side="right") - 1]])
    chosen = (position, velocity, acceleration, outside, signal(".pressure_1"), signal(".pressure_2"), travelled)
    return Rows(*(values[keep] for values in chosen))


def _put_right(values: Array, column: str, machine: Machine) -> tuple[Array, float]:
    """Return the truth behind a column, reading = factor * truth(t - delay) + bias, and its delay [s]."""
    unit = {"position": "m", "velocity": "m/s", "external_force": "N"}.get(column.rpartition(".")[2], "Pa")
    late = 0.0
    for name, where, table in machine.effects:
        if where == column and name == "sensor_bias":
            values = values - units.parse(table["value"], unit)
    for name, where, table in machine.effects:
        if where == column and name == "sensor_scale":
            values = values / units.parse(table["factor"], "1")
        elif where == column and name == "sensor_delay":
            late = units.parse(table["seconds"], "s")
    return values, late


def outside_force(machine: Machine, at: Rows) -> Array:
    """Return the force from outside that the rig's numbers demand at these rows [N], shape (n,)."""
    v = at.velocity
    demanded = machine.mass * at.acceleration + machine.weight + machine.damping * v + machine.friction * np.sign(v)
    gauges = np.zeros_like(v)
    if machine.area_1 > 0:
        first = np.nan_to_num(at.pressure_1, nan=machine.ambient) - machine.ambient
        second = np.zeros_like(v) if machine.single else np.nan_to_num(at.pressure_2, nan=machine.ambient) - machine.ambient
        demanded = demanded - first * machine.area_1 + second * machine.area_2
        gauges = np.maximum(first, 0.0) + np.maximum(second, 0.0)
    dry = machine.friction + np.zeros_like(v)
    late = ("stribeck_friction", "presliding")  # these take up what the others hold
    for name, _, table in sorted(machine.effects, key=lambda effect: late.index(effect[0]) if effect[0] in late else -1):
        if name == "unknown":
            demanded = demanded - _curve(table, at)
        elif name in _LAWS:
            force = _LAWS[name](table, at, gauges, dry)
            demanded = demanded + force
            if name in ("coulomb_friction", "asymmetric_friction", "pressure_dependent_friction", "stribeck_friction"):
                dry = dry + np.abs(force)
    return demanded


def balance_error(machine: Machine, recordings: tuple[Recording, ...], moving: Moving) -> float:
    """Return the rms over all rows of what the demanded force misses the recorded one by [N]."""
    misses = []
    for recording in recordings:
        at = rows(recording, moving, machine)
        misses.append(outside_force(machine, at) - at.outside)
    return float(np.sqrt(np.mean(np.concatenate(misses) ** 2)))


def _coulomb(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    return units.parse(table["force"], "N") * np.sign(at.velocity)


def _asymmetric(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    forward, backward = (units.parse(table[key], "N") for key in ("forward", "backward"))
    return np.where(at.velocity > 0, forward, -backward)


def _viscous(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    """Return the resistance of a film; the power of speed may be given, the coefficient then stands at 0.1 m/s."""
    thinned = np.maximum(np.abs(at.velocity), 1e-3) / 0.1
    return units.parse(table["coefficient"], "N*s/m") * at.velocity * thinned ** (float(table.get("index", 1.0)) - 1.0)


def _stribeck(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    """Return what breakaway adds to the other dry friction; an exponent other than 2 may be given, and a tail."""
    excess = np.maximum(units.parse(table["breakaway"], "N") - dry, 0.0)
    power, tail = float(table.get("exponent", 2.0)), float(table.get("tail", 0.0))
    fallen = (np.abs(at.velocity) / units.parse(table["velocity"], "m/s")) ** power
    left = (1.0 + tail * fallen) ** (-1.0 / tail) if tail > 0.0 else np.exp(-fallen)
    return np.sign(at.velocity) * excess * left


def _presliding(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    """Return what bristles still lack after a turn: F = dry (1 - 2 exp(-stiffness travelled / dry)), the Dahl limit of LuGre."""
    held = np.maximum(dry, 1e-9)
    return -2.0 * np.sign(at.velocity) * held * np.exp(-units.parse(table["stiffness"], "N/m") * at.travelled / held)


def _with_pressure(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    return units.parse(table["coefficient"], "m^2") * gauges * np.sign(at.velocity)


def _drag(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    return units.parse(table["coefficient"], "N*s^2/m^2") * at.velocity * np.abs(at.velocity)


def _spring(table: Mapping[str, Any], at: Rows, gauges: Array, dry: Array) -> Array:
    return units.parse(table["stiffness"], "N/m") * (at.position - units.parse(table["rest"], "m"))


_LAWS = {
    "coulomb_friction": _coulomb,
    "asymmetric_friction": _asymmetric,
    "viscous_friction": _viscous,
    "stribeck_friction": _stribeck,
    "presliding": _presliding,
    "pressure_dependent_friction": _with_pressure,
    "quadratic_drag": _drag,
    "return_spring": _spring,
}


def _curve(table: Mapping[str, Any], at: Rows) -> Array:
    """Return the force of an unknown's curve, + outwards, its last value kept beyond its ends; zero for a flow."""
    if table.get("acts") != "force":
        return np.zeros_like(at.velocity)
    variable, unit = {
        "position": (at.position, "m"),
        "velocity": (at.velocity, "m/s"),
        "pressure_1": (at.pressure_1, "Pa"),
        "pressure_2": (at.pressure_2, "Pa"),
        "pressure_difference": (at.pressure_1 - at.pressure_2, "Pa"),
    }[table["depends_on"]]
    knots = [units.parse(text, unit) for text in table["at"]]
    return np.interp(variable, knots, [units.parse(text, "N") for text in table["values"]])
