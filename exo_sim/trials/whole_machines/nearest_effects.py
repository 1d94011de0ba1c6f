"""A machine's own laws in the contract's words: the effects and numbers with which a rig comes nearest to it.

Where laws agree the numbers are copied. Where they differ the contract's law is fitted to the machine's own: friction to what a seal
did while a recording was made, the valve's flow over all pressure ratios, heat at the mean state, a lag by its delay at low frequencies.
"""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, minimize_scalar

from exo_sim.trials.whole_machines.friction_laws import level, viscous
from exo_sim.trials.whole_machines.gas_laws import CLEARANCE, ELLIPSE, GAP, ORIFICE, POROUS, conductance, flow_factor, leak
from exo_sim.trials.whole_machines.machine import Machine
from exo_sim.trials.whole_machines.machine_run import Run
from exo_sim.trials.whole_machines.make import Make
from exo_sim.trials.whole_machines.published_cylinders import hose_conductance, throat_area

Array = NDArray[np.float64]
Parameters = dict[str, tuple[float, str]]
FRICTION = ("coulomb", "stribeck", "viscous", "pressure", "asymmetry", "drag")


def rig_effects(m: Machine, make: Make, keys: Collection[str], seen: Run) -> dict[tuple[str, str], Parameters]:
    """Return (name, where) to parameters of the contract for the blocks named.

    Args:
        m: The machine as it is.
        make: Its make.
        keys: Of `hidden_effects.BLOCKS`; those outside the list are left out.
        seen: A run that says which speeds and pressures the machine meets.
    """
    found: dict[tuple[str, str], Parameters] = {}
    here = make.cylinder
    dry = [key for key in keys if key in FRICTION]
    if dry:
        found |= {(name, here): parameters for name, parameters in _friction(m, set(dry), seen).items()}
    for key in keys:
        if key in _DIRECT:
            name, where, parameters = _DIRECT[key](m, seen)
            if parameters:
                found[name, here if where == "cylinder" else where] = parameters
    return found


def _friction(m: Machine, keys: set[str], seen: Run) -> dict[str, Parameters]:
    """Fit the contract's friction to the machine's own over the speeds and pressures of a run.

    Blocks that are not in `keys` are somebody else's business: they are taken off the machine first.
    """
    without = {"coulomb": ("coulomb",), "stribeck": ("breakaway_excess",), "viscous": ("viscous",), "pressure": ("pressure_friction",),
               "asymmetry": ("asymmetry",)}  # fmt: skip
    own = m.without(*(name for key, names in without.items() if key not in keys for name in names))
    record = own.packed()[0]
    log = seen.log
    moving = np.flatnonzero(np.abs(log["piston_speed"]) > 3e-4)
    rows = moving[:: max(1, len(moving) // 1500)]
    if len(rows) < 50:
        return {}
    v, x, p1, p2 = (log[name][rows] for name in ("piston_speed", "piston", "pressure_1", "pressure_2"))
    true = np.array([
        math.copysign(level(s, a, b, c, 0.0, 0.0, record), s) + viscous(s, 0.0, record) + own["drag"] * abs(s) * s
        for s, a, b, c in zip(v, x, p1, p2)
    ])  # fmt: skip
    gauge = np.maximum(p1 - m["ambient"], 0) + np.maximum(p2 - m["ambient"], 0)
    # slow motion is rare in samples and decides what sticks
    weight = (
        1.0
        / np.sqrt(np.histogram(np.log(np.abs(v)), 12)[0].clip(1))[
            np.clip(np.digitize(np.log(np.abs(v)), np.histogram(np.log(np.abs(v)), 12)[1]) - 1, 0, 11)
        ]
    )
    names = [name for key, name in (("coulomb", "force"), ("stribeck", "excess"), ("stribeck", "speed"), ("viscous", "viscous"),
                                    ("pressure", "pressure"), ("asymmetry", "asymmetry"), ("drag", "drag")) if key in keys]  # fmt: skip
    start = {"force": own["coulomb"], "excess": own["breakaway_excess"], "speed": own["stribeck_speed"], "viscous": own["viscous"],
             "pressure": own["pressure_friction"] * 0.6, "asymmetry": own["asymmetry"], "drag": own["drag"]}  # fmt: skip
    scale = np.array([max(abs(start[name]), 1e-12) for name in names])

    def model(theta: Array) -> Array:
        t = dict(zip(names, theta * scale))
        dry = t.get("force", 0.0) + t.get("pressure", 0.0) * gauge
        dry = dry * (1 + t.get("asymmetry", 0.0) * np.sign(v))
        dry = dry + t.get("excess", 0.0) * np.exp(-((v / t.get("speed", 1.0)) ** 2))
        return np.sign(v) * dry + t.get("viscous", 0.0) * v + t.get("drag", 0.0) * abs(v) * v

    low = [-2.0 if name == "asymmetry" else (0.05 if name == "speed" else 0.0) for name in names]
    fit = least_squares(lambda theta: (model(theta) - true) * weight, np.sign([start[name] or 1.0 for name in names]).astype(float),
                        bounds=(low, 8.0))  # fmt: skip
    t = dict(zip(names, fit.x * scale))
    found: dict[str, Parameters] = {}
    force = t.get("force", 0.0)
    if "asymmetry" in t:
        found["asymmetric_friction"] = {
            "forward": (force * (1 + t["asymmetry"]), "N"), "backward": (force * (1 - t["asymmetry"]), "N")
        }  # fmt: skip
    elif "force" in t:
        found["coulomb_friction"] = {"force": (force, "N")}
    if "excess" in t:
        sliding = force + t.get("pressure", 0.0) * float(np.mean(gauge))
        found["stribeck_friction"] = {"breakaway": (sliding + t["excess"], "N"), "velocity": (t["speed"], "m/s")}
    if "viscous" in t:
        found["viscous_friction"] = {"coefficient": (t["viscous"], "N*s/m")}
    if "pressure" in t:
        found["pressure_dependent_friction"] = {"coefficient": (t["pressure"], "m^2")}
    if "drag" in t:
        found["quadratic_drag"] = {"coefficient": (t["drag"], "N s^2/m^2")}
    return found


def nearest_ratio(m: Machine) -> float:
    """Return the critical ratio of the half-power ellipse that is nearest to the machine's law of flow."""
    ratios = np.linspace(0.15, 0.98, 60)
    own = np.array([flow_factor(r, m["flow_law"], m["flow_b"], m["flow_m"], m["heat_ratio"], m["flow_laminar"]) for r in ratios])

    def miss(b: float) -> float:
        there = np.array([flow_factor(r, ELLIPSE, b, 0.5, m["heat_ratio"]) for r in ratios])
        return float(np.sum((there - own) ** 2))

    return float(minimize_scalar(miss, bounds=(0.02, 0.6), method="bounded").x)


def mean_conductance(m: Machine, seen: Run) -> tuple[float, float]:
    """Return the mean conductance from gas to wall of either chamber over a run [W/K]."""
    log = seen.log
    rows = slice(None, None, max(1, len(log["piston"]) // 500))
    barrel = 2 * math.sqrt(math.pi * m["area_1"])
    means = []
    for number, length in (("1", log["piston"][rows]), ("2", m["stroke"] - log["piston"][rows])):
        values = [
            conductance(m["heat_law"], m["heat_conductance"], m["heat_coefficient"], 2 * m[f"area_{number}"], barrel, x, p, t, v)
            for x, p, t, v in zip(length, log[f"pressure_{number}"][rows], log[f"temperature_{number}"][rows], log["piston_speed"][rows])
        ]
        means.append(float(np.mean(values)))
    return means[0], means[1]


def _heat(m: Machine, seen: Run) -> Parameters:
    first, second = mean_conductance(m, seen)
    if m["single_acting"] == 1.0:  # its second chamber is the room
        return {"conductance_1": (first, "W/K")}
    if abs(first - second) < 0.1 * (first + second):
        return {"conductance": (0.5 * (first + second), "W/K")}
    return {"conductance_1": (first, "W/K"), "conductance_2": (second, "W/K")}


def _lag(m: Machine) -> Parameters:
    if m["spool_frequency"] > 0:
        omega = 2 * math.pi * m["spool_frequency"]
        mean = 2 * m["spool_damping"] / omega
        # a lag and a dead time of the same mean and spread as the second order's impulse response
        spread = math.sqrt(max(mean**2 - 2 / omega**2, 0.0))
        first = min(max(spread, 0.5 * mean), mean)
        return {"time_constant": (first, "s"), "delay": (max(mean - first, 0.0) + m["delay"], "s")}
    parameters: Parameters = {"time_constant": (0.5 * (m["lag"] + m["lag_back"]) if m["lag_back"] > 0 else m["lag"], "s")}
    return parameters | ({"delay": (m["delay"], "s")} if m["delay"] > 0 else {})


def _hose(m: Machine) -> Parameters:
    if m["hose_kind"] == 1.0:
        return {"area": (m["hose_area"], "m^2"), "volume": (m["hose_volume"], "m^3")}
    area = throat_area(hose_conductance(m["hose_bore"], m["hose_length"])[0])
    return {"area": (area, "m^2"), "volume": (0.25 * math.pi * m["hose_bore"] ** 2 * m["hose_length"], "m^3")}


def _leak_out(m: Machine) -> Parameters:
    kind, unit = ("area", "m^2") if m["leak_law"] == ORIFICE else ("laminar", "kg/(s Pa^2)")
    found: Parameters = {}
    for n in ("1", "2"):
        size = m[f"leak_{n}"]
        if size > 0:
            found[f"{kind}_{n}"] = _as_gap(m, size, 4e5, m["ambient"]) if m["leak_law"] == CLEARANCE else size, unit
    return found | ({"inertial": (m["leak_inertial"], "Pa^2 s^2/kg^2")} if m["leak_law"] == POROUS else {})


def _leak_piston(m: Machine) -> Parameters:
    if m["leak_law"] == ORIFICE:
        return {"area": (m["leak_piston"], "m^2")}
    size = m["leak_piston"]
    if m["leak_law"] != GAP:
        size = _as_gap(m, size, 5e5, 2e5)
    return {"laminar": (size, "kg/(s Pa^2)")}


def _as_gap(m: Machine, size: float, high: float, low: float) -> float:
    """Return the size [kg/(s Pa^2)] of the gap that passes between two pressures [Pa] what the machine's leak of this size does."""
    passed = leak(size, high, 293.15, low, 293.15, m["leak_law"], m["leak_inertial"], m["leak_turning"], m.packed()[0])
    return float(passed) / (high**2 - low**2)


def _laps(m: Machine) -> Parameters:
    return {"width": (float(np.mean([m[name] for name in ("lap_s1", "lap_e1", "lap_s2", "lap_e2")])), "1")}


_DIRECT = {
    "heat": lambda m, seen: ("wall_heat_transfer", "cylinder", _heat(m, seen)),
    "wall": lambda m, seen: ("moving_wall_temperature", "cylinder", {"heat_capacity": (m["wall_capacity"], "J/K"),
                                                                     "outside_conductance": (m["wall_outside"], "W/K")}),
    "deadband": lambda m, seen: ("valve_deadband", "cylinder", _laps(m)),
    "shift": lambda m, seen: ("valve_offset", "cylinder", {"shift": (m["shift"], "1")}),
    "lag": lambda m, seen: ("valve_lag", "cylinder", _lag(m)),
    "rate": lambda m, seen: ("spool_rate_limit", "cylinder", {"rate": (m["rate"], "1/s")}),
    "play": lambda m, seen: ("valve_hysteresis", "cylinder", {"width": (m["play"], "1")}),
    "null": lambda m, seen: ("valve_null_leakage", "cylinder", {"area": (m["null_area"], "m^2")}),
    "flow": lambda m, seen: ("critical_ratio", "cylinder", {"ratio": (nearest_ratio(m), "1")}),
    "hose": lambda m, seen: ("line_restriction", "cylinder", _hose(m)),
    "leak_out": lambda m, seen: ("external_leakage", "cylinder", _leak_out(m)),
    "leak_piston": lambda m, seen: ("piston_leakage", "cylinder", _leak_piston(m)),
    "silencer": lambda m, seen: ("exhaust_back_pressure", "exhaust", {"area": (m["exhaust_area"], "m^2"),
                                                                     "volume": (m["exhaust_volume"], "m^3")}),
    "tank": lambda m, seen: ("supply_droop", "supply", {"volume": (m["tank_volume"], "m^3"),
                                                        "conductance": (m["tank_feed"], "kg/(s Pa)")}),
    "regulator": lambda m, seen: ("supply_regulator", "supply", {"droop": (m["regulator_droop"], "Pa s/kg"),
                                                                 "time_constant": (m["regulator_time"], "s")}),
    "cushion": lambda m, seen: ("end_cushioning", "cylinder", {"length": (m["cushion_length"], "m"), "area": (m["cushion_area"], "m^2")}),
    "mount": lambda m, seen: ("transmission_compliance", "cylinder", {"stiffness": (m["mount_stiffness"], "N/m")}),
    "spring": lambda m, seen: ("return_spring", "cylinder", {"stiffness": (m["spring"], "N/m"), "rest": (m["spring_rest"], "m")}),
}  # fmt: skip
