"""The best honest model of each machine, by plain least squares: what an improved rig is held against.

Nothing here is shared with the simulator. *Slides* (seals, the positioning system, the vented spring): m a = F_out + (P1 - P_atm) A1 -
(P2 - P_atm) A2 - m g - R at rows that move, R linear in its numbers: sign(v) (Coulomb), sign(v) times gauge pressure (seals), v
(viscous), max(v, 0) and min(v, 0) where the directions differ, gauge pressure and a constant (a scale and a zero of the sensors), the
position. *Gas springs*: a closed mass of gas with one coefficient of heat to a wall of constant temperature. With T = theta V^(1-k),
d theta / d t = g (T_wall V^(k-1) - theta), g = G / (m c_v), a first-order filter of known input; numbers: dead volume, G, the gas's first
temperature, how late the logger is. *Decay*: an isothermal vessel behind a porous path, p^2 - p_atm^2 = w / a + b w^2 (Forchheimer).
Each is fitted to what the tool is given and held against what is held out, by the measure of the case.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import lfilter

from exo_sim import units
from exo_sim.recording import Recording
from exo_sim.trials.real.balance import Machine, Rows, outside_force, read_machine, rows
from exo_sim.trials.real.case import TAIL, RealCase

Array = NDArray[np.float64]

_SEAL = ("dry", "growing", "viscous", "scale", "zero", "place")
_TERMS: dict[str, tuple[str, ...]] = {
    "emps": ("mass", "dry", "zero", "outward", "inward"),
    "kdn": _SEAL,
    "o_ring": _SEAL,
    "seal_napn": _SEAL,
    "seal_pk": _SEAL,
    "spring_vented": ("dry", "viscous", "zero"),
}


def _feature(name: str, at: Rows, machine: Machine) -> Array:
    gauge = np.nan_to_num(at.pressure_1 - machine.ambient)
    values: dict[str, Array] = {
        "mass": at.acceleration,
        "dry": np.sign(at.velocity),
        "growing": np.sign(at.velocity) * gauge,
        "viscous": at.velocity,
        "outward": np.maximum(at.velocity, 0.0),
        "inward": np.minimum(at.velocity, 0.0),
        "scale": gauge,
        "zero": np.ones_like(at.velocity),
        "place": at.position,
    }
    return values[name]


def slide(case: RealCase, rig: Path) -> dict[str, float]:
    """Return the honest model's rms of force on what is held out [N]."""
    assert case.moving is not None
    machine = read_machine(rig)

    def system(recordings: tuple[Recording, ...]) -> tuple[Array, Array]:
        parts = [rows(recording, case.moving, machine) for recording in recordings]  # type: ignore[arg-type]
        features = np.vstack([np.column_stack([_feature(name, at, machine) for name in _TERMS[_base(case)]]) for at in parts])
        return features, np.concatenate([at.outside - outside_force(machine, at) for at in parts])

    features, missed = system(case.recordings)
    numbers = np.linalg.lstsq(features, missed, rcond=None)[0]
    features, missed = system(case.held)
    return {"slide.external_force": float(np.sqrt(np.mean((features @ numbers - missed) ** 2)))}


def _base(case: RealCase) -> str:
    return case.variant_of or case.name


def spring(case: RealCase, rig: Path) -> dict[str, float]:
    """Return the honest model's rms of both pressures in a free run [Pa]."""
    numbers = tomllib.loads(rig.read_text(encoding="utf-8"))
    name, cylinder = next(iter(numbers["cylinders"].items()))
    ratio = float(numbers["gas"]["heat_capacity_ratio"])
    bore, rod, stroke = (units.parse(cylinder[key], "m") for key in ("bore", "rod", "stroke"))
    areas = {"1": 0.25 * np.pi * bore**2, "2": 0.25 * np.pi * (bore**2 - rod**2)}
    errors = {}
    (given,), (held,) = case.recordings, case.held
    for side, area in areas.items():
        dead = units.parse(cylinder[f"dead_volume_{side}"], "m^3")

        def length(run: Recording, outward: bool = side == "1") -> Array:
            place = next(values for key, values in run.columns.items() if key.endswith(".position"))
            return place if outward else stroke - place

        signal = f"{name}.pressure_{side}"
        start = given[signal][0] * (dead + area * length(given)[0])

        def run_of(run: Recording, theta: Array, late: bool = True) -> Array:
            volume = dead * theta[0] + area * length(run)  # noqa: B023
            first = run[signal][0]  # noqa: B023
            rate = theta[1] * start / (first * volume[0])  # noqa: B023
            warm = _temperature(run.time, volume, rate, theta[2], ratio)
            pressure = first * warm / warm[0] * volume[0] / volume
            return np.interp(run.time - (theta[3] if late else 0.0), run.time, pressure)

        def missed(theta: Array) -> Array:
            return 1e-3 * (run_of(given, theta) - given[signal])  # noqa: B023

        fit = least_squares(missed, [1.0, 0.2, 1.0, 0.1], x_scale=[0.1, 0.05, 0.05, 0.1], bounds=([0.5, 1e-4, 0.8, -1.0], [2, 5, 1.2, 1.0]))
        theta = fit.x if case.measure == TAIL else np.array([*fit.x[:2], 1.0, 0.0])
        error = run_of(held, theta) - held[signal]
        kept = held.time > given.time[-1] if case.measure == TAIL else np.ones(len(held.time), dtype=bool)
        errors[signal] = float(np.sqrt(np.mean(error[kept] ** 2)))
    return errors


def _temperature(time: Array, volume: Array, rate: float, first: float, ratio: float) -> Array:
    """Return the gas's temperature over the wall's, shape (n,): exact where V^(k-1) is a line between samples."""
    step = float(np.median(np.diff(time)))
    driven = volume ** (ratio - 1)
    fade = np.exp(-rate * step)
    late, soon = (1 - fade) / (rate * step) - fade, 1 - (1 - fade) / (rate * step)
    start = first * driven[0]
    rest, _ = lfilter([1.0], [1.0, -fade], soon * driven[1:] + late * driven[:-1], zi=[fade * start])
    return np.concatenate([[start], rest]) / driven


def decay(case: RealCase, rig: Path) -> dict[str, float]:
    """Return the honest model's rms of the pressure of a leaking vessel in a free run [Pa]."""
    numbers = tomllib.loads(rig.read_text(encoding="utf-8"))
    ambient = units.parse(numbers.get("environment", {}).get("pressure", "101325 Pa"), "Pa")
    (given,), (held,) = case.recordings, case.held
    signal = "piston.pressure_1"

    def run(time: Array, theta: Array, first: float) -> Array:
        conductance, inertial = np.exp(theta)  # of w over V / R T, so of dp/dt
        pressures, p = [first], first
        for step in np.diff(time):
            for _ in range(4):
                head = (p**2 - ambient**2) / 1e10
                flow = 2 * head / (1 / conductance + np.sqrt(1 / conductance**2 + 4 * inertial * max(head, 0.0)))
                p -= 1e5 * flow * step / 4
            pressures.append(p)
        return np.array(pressures)

    inside = given.time >= case.held_from
    first = float(given[signal][inside][0])
    fit = least_squares(lambda theta: 1e-3 * (run(given.time[inside], theta, first) - given[signal][inside]), np.log([1e-2, 1.0]))
    after = held.time >= case.held_from
    error = run(held.time[after], fit.x, first) - held[signal][after]
    kept = held.time[after] > given.time[-1]
    return {signal: float(np.sqrt(np.mean(error[kept] ** 2)))}


_MODELS: Mapping[str, Callable[[RealCase, Path], dict[str, float]]] = {
    **dict.fromkeys(_TERMS, slide),
    "gas_spring": spring,
    "spring_moving": spring,
    "ultimaker": decay,
}


def honest_errors(case: RealCase, rig: Path) -> dict[str, float]:
    """Return the error of the best honest model on what is held out, by signal; empty where none is computed here.

    Args:
        case: The case, or a variant: the model is fitted to what that is given.
        rig: The rig as handed in, rig.toml.
    """
    model = _MODELS.get(_base(case))
    return model(case, rig) if model else {}
