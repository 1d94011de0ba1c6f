"""Rivals to hold a diagnosis against, on the same cases and under the same contract.

    exo-sim trial run trial --tool "python -m exo_sim.trials.rivals prune"

Four of them: `nothing` finds every machine consistent; the others regress what the paper's balances leave over on one
column an effect, in weak form (windows of a smooth test function, derivatives moved onto it), and differ in how they
choose: `threshold` drops small terms until none is left to drop (as SINDy does), `prune` fits everything and drops the
term that is missed least, `greedy` adds the term that lowers the error most.
"""

from __future__ import annotations

import argparse
import json
import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WINDOW = 0.25
#: A term must lower the error by this share to stay.
SHARE = 0.03
KAPPA, GAS = 1.4, 287.05
_UNITS = {"mm": 1e-3, "m": 1.0, "cm^3": 1e-6, "mm^2": 1e-6, "bar": 1e5, "Pa": 1.0, "K": 1.0}


@dataclass(frozen=True)
class Regression:
    """One balance in weak form: what is left over and what could explain it.

    Attributes:
        where: Part and equation.
        rest: What the paper leaves over, shape (n,).
        columns: Effect to (weak column, shape (n,), parameter name or "").
    """

    where: tuple[str, str]
    rest: Array
    columns: dict[str, tuple[Array, str]]


def _si(text: str | float) -> float:
    if isinstance(text, int | float):
        return float(text)
    value, _, unit = text.partition(" ")
    return float(value) * _UNITS.get(unit, 1.0)


def _read(path: Path) -> dict[str, Array]:
    if path.suffix == ".parquet":
        import pyarrow.parquet as pq

        table = pq.read_table(path)
        return {name.split(" [")[0]: table[name].to_numpy() for name in table.column_names}
    with path.open() as lines:
        names = [name.split(" [")[0] for name in lines.readline().strip().split(",")]
    values = np.genfromtxt(path, delimiter=",", skip_header=1)
    return {name: values[:, i] for i, name in enumerate(names)}


def _flow(area: Any, up: Array, down: Array, temperature: float) -> Array:
    """Return the nozzle flow from `up` to `down`, both ways [kg/s]."""
    high, low = np.maximum(up, down), np.minimum(up, down)
    r = np.clip(low / high, 0.52828, 1.0)
    factor = np.sqrt(np.maximum(2 / (KAPPA - 1) * (r ** (2 / KAPPA) - r ** ((KAPPA + 1) / KAPPA)), 0.0))
    return np.sign(up - down) * area * high * np.sqrt(KAPPA / (GAS * temperature)) * factor


def _weak(time: Array) -> Callable[[Array, bool], Array]:
    """Return what integrates a signal, or its derivative, against the test functions, shape (n,) to (windows,)."""
    step = float(np.median(np.diff(time)))
    half = max(round(WINDOW / step / 2), 4)
    s = np.arange(-half, half + 1) / half
    bump = (1 - s**2) ** 4
    slope = -8 * s * (1 - s**2) ** 3 / (half * step)
    starts = np.arange(0, len(time) - 2 * half - 1, half // 2)
    rows = starts[:, None] + np.arange(2 * half + 1)

    def integrate(signal: Array, derivative: bool = False) -> Array:
        return signal[rows] @ (-slope if derivative else bump) * step

    return integrate


def _smooth_rate(values: Array, time: Array) -> Array:
    from scipy.signal import savgol_filter

    return savgol_filter(values, 31, 2, deriv=1, delta=float(np.median(np.diff(time))))


def gas_balance(
    name: str, cylinder: dict[str, Any], rig: dict[str, Any], table: dict[str, Array], x: Array
) -> Regression:
    """Return the mass-and-energy balance of both chambers of a cylinder; `x` is the piston's place [m]."""
    time = table["time"]
    weak = _weak(time)
    t0, ambient = _si(rig["supply"]["temperature"]), _si(rig["environment"]["pressure"])
    supply = np.full(len(time), _si(rig["supply"]["pressure"]))
    if "supply.pressure" in table:
        supply = table["supply.pressure"]
    bore, rod, stroke = _si(cylinder["bore"]), _si(cylinder["rod"]), _si(cylinder["stroke"])
    area = _si(cylinder["valve"]["area"])
    u = table[f"{name}.valve_command"]
    u = 0.5 * (u + np.concatenate((u[:1], u[:-1])))  # held until the next sample
    turn = np.sign(_smooth_rate(u, time)) * (np.abs(_smooth_rate(u, time)) > 0.02)
    rest: list[Array] = []
    columns: dict[str, tuple[list[Array], str]] = {}
    exhaust = np.full(len(time), ambient)
    for number, sign in ((1, 1.0), (2, -1.0)):
        face = math.pi / 4 * (bore**2 - (0 if number == 1 else rod**2))
        dead = _si(cylinder[f"dead_volume_{number}"])
        volume = dead + face * (x if number == 1 else stroke - x)
        p = table[f"{name}.pressure_{number}"]
        other = table[f"{name}.pressure_{3 - number}"]
        scale = 1 / (KAPPA * GAS * t0)
        # V dP + k P dV = d(PV) + (k - 1) P dV
        power = p * sign * face * _smooth_rate(x, time)
        stored = scale * (weak(p * volume, True) + (KAPPA - 1) * weak(power, False))
        opened = u * sign
        filling, venting = _flow(area, supply, p, t0), _flow(area, p, exhaust, t0)
        entering = opened * np.where(opened > 0, filling, venting)
        # change of flow with the command; at null half of either
        gain = sign * np.select([opened > 0, opened < 0], [filling, venting], 0.5 * (filling + venting))
        warm = np.log(p / p.mean())
        relaxed = warm - _lag(warm, time, 0.5)
        slowed = filling * np.maximum(opened, 0.0) * np.clip(p / supply - 0.4, 0, 1)
        rest.append(stored - weak(entering, False))
        parts = {
            "flow_capacity": (entering, "factor"),
            "dead_volume": (-scale * dead * _smooth_rate(p, time), ""),
            "wall_heat_transfer": (-(KAPPA - 1) / KAPPA / (GAS * t0) * t0 * 0.2857 * relaxed, "conductance"),
            "piston_leakage": (_flow(1.0, other, p, t0), "area"),
            "external_leakage": (-_flow(1.0, p, exhaust, t0) if number == 1 else 0 * p, "area_1"),
            "external_leakage_2": (-_flow(1.0, p, exhaust, t0) if number == 2 else 0 * p, "area_2"),
            "valve_null_leakage": (_flow(1.0, supply, p, t0) - _flow(1.0, p, exhaust, t0), "area"),
            "valve_offset": (gain, "shift"),
            "valve_deadband": (-gain * np.sign(u) * (1 - np.abs(u)), "width"),
            "valve_lag": (-gain * _smooth_rate(u, time), "time_constant"),
            "valve_hysteresis": (-0.5 * gain * turn, "width"),
            "critical_ratio": (-slowed, ""),
        }
        for effect, (signal, parameter) in parts.items():
            columns.setdefault(effect, ([], parameter))[0].append(weak(signal, False))
    stacked = {effect: (np.concatenate(pieces), parameter) for effect, (pieces, parameter) in columns.items()}
    return Regression((name, "energy balance"), np.concatenate(rest), stacked)


def _lag(values: Array, time: Array, constant: float) -> Array:
    from scipy.signal import lfilter

    keep = math.exp(-float(np.median(np.diff(time))) / constant)
    return lfilter([1 - keep], [1, -keep], values - values[0]) + values[0]


def force_balance(
    name: str,
    cylinder: dict[str, Any],
    rig: dict[str, Any],
    table: dict[str, Array],
    x: Array,
    joint: Array,
    model: Any,
) -> Regression:
    """Return Newton's law of a bench with one slide; `joint` is the joint position [m]."""
    time = table["time"]
    weak = _weak(time)
    ambient = _si(rig["environment"]["pressure"])
    bore, rod = _si(cylinder["bore"]), _si(cylinder["rod"])
    a1, a2 = math.pi / 4 * bore**2, math.pi / 4 * (bore**2 - rod**2)
    p1, p2 = table[f"{name}.pressure_1"], table[f"{name}.pressure_2"]
    mass = float(model.body_subtreemass[1])
    weight = -mass * float(model.opt.gravity @ model.jnt_axis[0])
    v = _smooth_rate(x, time)
    moving = np.tanh(v / 2e-3)
    force = p1 * a1 - p2 * a2 - ambient * (a1 - a2)
    spring = float(model.jnt_stiffness[0]) * (joint - float(model.qpos_spring[0]))
    rest = weak(mass * v, True) - weak(force - weight - spring - float(model.dof_damping[0]) * v, False)
    signals = {
        "coulomb_friction": (-moving, "force"),
        "viscous_friction": (-v, "coefficient"),
        "quadratic_drag": (-v * np.abs(v), "coefficient"),
        "pressure_dependent_friction": (-moving * (p1 + p2 - 2 * ambient), "coefficient"),
        "stribeck_friction": (-moving * np.exp(-((v / 0.03) ** 2)), ""),
        "asymmetric_friction": (-np.abs(moving), ""),
        "return_spring": (-(x - x.mean()), "stiffness"),
    }
    columns = {effect: (weak(signal, False), parameter) for effect, (signal, parameter) in signals.items()}
    acceleration = weak(v, True) + weak(np.full(len(x), weight / mass), False)
    columns["payload_mass"] = (-acceleration, "")
    return Regression((name, "force balance"), rest, columns)


def choose(regression: Regression, how: str) -> dict[str, tuple[float, float, float]]:
    """Return effect to (coefficient, its standard error, share of the error that it explains)."""
    names = list(regression.columns)
    table = np.column_stack([regression.columns[name][0] for name in names])
    norms = np.linalg.norm(table, axis=0)
    alive = norms > 0
    names, table = [name for name, ok in zip(names, alive) if ok], table[:, alive] / norms[alive]
    rest = regression.rest
    odd = (np.arange(len(rest)) // 40) % 2 == 1

    def error(chosen: list[int]) -> float:
        """Held-out error: fitted on every other block, counted on the rest."""
        if not chosen:
            return float(np.sqrt(np.mean(rest[odd] ** 2)))
        fit = np.linalg.lstsq(table[~odd][:, chosen], rest[~odd], rcond=1e-8)[0]
        return float(np.sqrt(np.mean((rest[odd] - table[odd][:, chosen] @ fit) ** 2)))

    everything = list(range(len(names)))
    chosen: list[int] = [] if how == "greedy" else everything
    while how == "greedy" and len(chosen) < len(names):
        best = min((k for k in everything if k not in chosen), key=lambda k: error([*chosen, k]))
        if error([*chosen, best]) > (1 - SHARE) * error(chosen):
            break
        chosen.append(best)
    while how == "prune" and chosen:
        least = min(chosen, key=lambda k: error([c for c in chosen if c != k]))
        if error([c for c in chosen if c != least]) > (1 + SHARE) * error(chosen):
            break
        chosen = [c for c in chosen if c != least]
    while how == "threshold" and chosen:
        fit = np.linalg.lstsq(table[:, chosen], rest, rcond=1e-8)[0]
        kept = [c for c, value in zip(chosen, fit) if abs(value) > 0.15 * np.linalg.norm(rest)]
        if len(kept) == len(chosen):
            break
        chosen = kept
    if not chosen:
        return {}
    fit = np.linalg.lstsq(table[:, chosen], rest, rcond=1e-8)[0]
    noise = np.sqrt(np.mean((rest - table[:, chosen] @ fit) ** 2))
    spread = noise * np.sqrt(np.diag(np.linalg.pinv(table[:, chosen].T @ table[:, chosen])))
    scale = norms[alive]
    full = error(chosen)
    gained = {k: 1 - full / max(error([c for c in chosen if c != k]), 1e-30) for k in chosen}
    return {names[k]: (v / scale[k], sigma / scale[k], gained[k]) for k, v, sigma in zip(chosen, fit, spread)}


def diagnose(recordings: list[Path], rig_path: Path, how: str) -> dict[str, Any]:
    """Return a diagnosis of the first recording, as the contract wants it."""
    import mujoco

    report: dict[str, Any] = {"schema": "exo-sim/diagnosis/1", "verdict": "consistent", "located": [], "effects": []}
    if how == "nothing":
        return report
    rig = tomllib.loads(rig_path.read_text())
    model = mujoco.MjModel.from_xml_path(str(rig_path.parent / rig["model"]))
    data = mujoco.MjData(model)
    table = _read(recordings[0])
    joints = [model.joint(i).name for i in range(model.njnt)]
    if any(f"{joint}.position" not in table for joint in joints):
        return report | {"verdict": "undetermined"}
    length = np.empty((len(table["time"]), model.nu))
    for i in range(len(length)):
        for joint in joints:
            data.joint(joint).qpos = table[f"{joint}.position"][i]
        mujoco.mj_fwdPosition(model, data)
        length[i] = data.actuator_length
    for name, cylinder in rig["cylinders"].items():
        if any(f"{name}.pressure_{n}" not in table for n in (1, 2)):
            report["verdict"] = "undetermined"
            continue
        x = length[:, model.actuator(cylinder["actuator"]).id] - _si(cylinder["retracted_length"])
        balances = [gas_balance(name, cylinder, rig, table, x)]
        if model.njnt == 1:
            position = table[f"{joints[0]}.position"]
            balances.append(force_balance(name, cylinder, rig, table, x, position, model))
        for balance in balances:
            for effect, (value, sigma, gained) in choose(balance, how).items():
                _add(report, balance, effect.removesuffix("_2"), effect, value, sigma, gained, joints[0])
    kinds = {entry["kind"] for entry in report["effects"]}
    if kinds:
        report["verdict"] = "calibration" if kinds == {"calibration"} else "mismatch"
    return report


def _add(
    report: dict[str, Any],
    balance: Regression,
    name: str,
    column: str,
    value: float,
    sigma: float,
    gained: float,
    joint: str,
) -> None:
    parameter = balance.columns[column][1]
    if name == "flow_capacity":
        value += 1
    calibration = name in ("flow_capacity", "dead_volume", "payload_mass")
    report["effects"].append(
        {
            "name": name,
            "where": joint if name == "payload_mass" else balance.where[0],
            "kind": "calibration" if calibration else "missing_physics",
            "parameters": {
                parameter: {"value": value, "unit": "1", "low": value - 1.96 * sigma, "high": value + 1.96 * sigma}
            }
            if parameter
            else {},
            "evidence": {"log10_odds": 2.0 + 100 * max(gained, 0.0), "held_out_error_drop": gained},
            "ambiguous_with": [],
        }
    )
    if not calibration:
        report["located"].append({"where": balance.where[0], "equation": balance.where[1], "share": gained})
        report["located"].sort(key=lambda entry: -entry["share"])


def main(argv: list[str] | None = None) -> int:
    """Diagnose like a rival; see `--help`."""
    parser = argparse.ArgumentParser(prog="python -m exo_sim.trials.rivals", description=__doc__.splitlines()[0])
    parser.add_argument("how", choices=("nothing", "threshold", "prune", "greedy"))
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--rig", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args(argv)
    report = diagnose(options.recordings, options.rig, options.how)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "diagnosis.json").write_text(json.dumps(report, indent=1))
    return {"consistent": 0, "calibration": 0, "mismatch": 3}.get(report["verdict"], 4)


if __name__ == "__main__":
    raise SystemExit(main())
