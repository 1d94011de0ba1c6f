"""What the paper's balances leave over, and one column for each effect that could explain it, in weak form.

Windows of a smooth test function; derivatives are moved onto it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from exo_sim.trials.rivals.files import Array, si

WINDOW = 0.25
KAPPA, GAS = 1.4, 287.05


@dataclass(frozen=True)
class Regression:
    """One balance in weak form: what is left over and what could explain it.

    Attributes:
        where: Part and equation.
        rest: What the paper leaves over, shape (n,).
        columns: Effect to (weak column, shape (n,), parameter name or "").
        inputs: Measured signals, smoothed alike, shape (n, signals).
    """

    where: tuple[str, str]
    rest: Array
    columns: dict[str, tuple[Array, str]]
    inputs: Array


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


def gas_balance(name: str, cylinder: dict[str, Any], rig: dict[str, Any], table: dict[str, Array], x: Array) -> Regression:
    """Return the mass-and-energy balance of both chambers of a cylinder; `x` is the piston's place [m]."""
    time = table["time"]
    weak = _weak(time)
    t0, ambient = si(rig["supply"]["temperature"]), si(rig["environment"]["pressure"])
    supply = np.full(len(time), si(rig["supply"]["pressure"]))
    if "supply.pressure" in table:
        supply = table["supply.pressure"]
    bore, rod, stroke = si(cylinder["bore"]), si(cylinder["rod"]), si(cylinder["stroke"])
    area = si(cylinder["valve"]["area"])
    u = table[f"{name}.valve_command"]
    u = 0.5 * (u + np.concatenate((u[:1], u[:-1])))  # held until the next sample
    turn = np.sign(_smooth_rate(u, time)) * (np.abs(_smooth_rate(u, time)) > 0.02)
    rest: list[Array] = []
    columns: dict[str, tuple[list[Array], str]] = {}
    exhaust = np.full(len(time), ambient)
    speed = _smooth_rate(x, time)
    inputs = []
    for number, sign in ((1, 1.0), (2, -1.0)):
        face = math.pi / 4 * (bore**2 - (0 if number == 1 else rod**2))
        dead = si(cylinder[f"dead_volume_{number}"])
        volume = dead + face * (x if number == 1 else stroke - x)
        p = table[f"{name}.pressure_{number}"]
        other = table[f"{name}.pressure_{3 - number}"]
        scale = 1 / (KAPPA * GAS * t0)
        # V dP + k P dV = d(PV) + (k - 1) P dV
        power = p * sign * face * speed
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
        inputs.append(np.column_stack([weak(each, False) for each in (p, other, x, sign * speed, opened)]))
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
    return Regression((name, "energy balance"), np.concatenate(rest), stacked, np.concatenate(inputs))


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
    ambient = si(rig["environment"]["pressure"])
    bore, rod = si(cylinder["bore"]), si(cylinder["rod"])
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
    inputs = np.column_stack([weak(each, False) for each in (x, v, p1, p2)])
    return Regression((name, "force balance"), rest, columns, inputs)
