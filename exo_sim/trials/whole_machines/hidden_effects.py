"""What a whole machine may hide: which fields each effect sets, and what a right answer calls it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from exo_sim.errors import TrialError, nearest
from exo_sim.trials.whole_machines import effect_sizes as sizes
from exo_sim.trials.whole_machines.effect_sizes import Draft, Fields
from exo_sim.trials.whole_machines.gas_laws import CLEARANCE, CONSTANT, GAP, ORIFICE
from exo_sim.trials.whole_machines.machine import Machine


@dataclass(frozen=True)
class Block:
    """One thing that a machine may have.

    Attributes:
        key: Its name here.
        name: Its name in the contract; "" for what is outside the list.
        place: "cylinder", "supply", "exhaust".
        family: Names of one family share a physical subsystem.
        draw: Draws its fields.
        off: The fields that it sets, which are taken away to see whether it matters.
        also: Other names of it that count as right.
        beside: Names that may stand beside it, neither right nor wrong: its law differs from the contract's in that way.
        units: Of the parameters that `exact` gives.
        exact: The contract's parameters of it as (value, low, high), where its law has them; an interval that meets low..high covers.
    """

    key: str
    name: str
    place: str
    family: str
    draw: Callable[[Draft], Fields]
    off: tuple[str, ...]
    also: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    exact: Callable[[Machine], dict[str, tuple[float, float, float]]] = lambda machine: {}


def _about(value: float, share: float = 0.0) -> tuple[float, float, float]:
    return value, value * (1.0 - share), value * (1.0 + share)


def _leak_out_exact(m: Machine) -> dict[str, tuple[float, float, float]]:
    found = {}
    if m["leak_law"] == CLEARANCE:
        return {}
    for number in ("1", "2"):
        if m[f"leak_{number}"] > 0:
            found[("area_" if m["leak_law"] == ORIFICE else "laminar_") + number] = _about(m[f"leak_{number}"], 0.02)
    if m["leak_law"] == 2.0:
        found["inertial"] = _about(m["leak_inertial"], 0.05)
    return found


def _leak_piston_exact(m: Machine) -> dict[str, tuple[float, float, float]]:
    if m["leak_law"] == ORIFICE:
        return {"area": _about(m["leak_piston"], 0.02)}
    return {"laminar": _about(m["leak_piston"], 0.02)} if m["leak_law"] == GAP else {}


def _lag_exact(m: Machine) -> dict[str, tuple[float, float, float]]:
    if m["spool_frequency"] > 0:
        return {}
    if m["lag_back"] > 0:
        return {"time_constant": (0.5 * (m["lag"] + m["lag_back"]), m["lag"], m["lag_back"])}
    found = {"time_constant": _about(m["lag"], 0.02)}
    return found | ({"delay": _about(m["delay"], 0.02)} if m["delay"] > 0 else {})


def _laps_exact(m: Machine) -> dict[str, tuple[float, float, float]]:
    laps = [m[name] for name in ("lap_s1", "lap_e1", "lap_s2", "lap_e2")]
    return {"width": (float(np.mean(laps)), min(laps), max(laps))}


def _hose_exact(m: Machine) -> dict[str, tuple[float, float, float]]:
    if m["hose_kind"] != 1.0:
        return {}
    # the contract's hose is a nozzle; an ellipse of lower b passes less below its critical ratio
    return {"area": (m["hose_area"], 0.85 * m["hose_area"], 1.05 * m["hose_area"]), "volume": _about(m["hose_volume"], 0.1)}


_LEAK_UNITS = {
    "area": "m^2", "laminar": "kg/(s Pa^2)", "inertial": "Pa^2 s^2/kg^2", "area_1": "m^2", "area_2": "m^2",
    "laminar_1": "kg/(s Pa^2)", "laminar_2": "kg/(s Pa^2)",
}  # fmt: skip

BLOCKS = {
    block.key: block
    for block in (
        Block("coulomb", "coulomb_friction", "cylinder", "friction", sizes.coulomb, ("coulomb",), (), ("presliding",),
              {"force": "N"}, lambda m: {"force": _about(m["coulomb"], 0.03)}),
        Block("stribeck", "stribeck_friction", "cylinder", "friction", sizes.stribeck,
              ("breakaway_excess", "stribeck_speed", "stribeck_exponent"), (), ("presliding",), {"breakaway": "N"},
              lambda m: {"breakaway": _about(m["coulomb"] + m["breakaway_excess"], 0.1)} if m["pressure_friction"] == 0 else {}),
        Block("viscous", "viscous_friction", "cylinder", "friction", sizes.viscous, ("viscous", "viscous_index"), (), (),
              {"coefficient": "N*s/m"},
              lambda m: {"coefficient": _about(m["viscous"], 0.05)} if m["viscous_index"] == 1 else {}),  # a joint's damping is in the MJCF
        Block("pressure", "pressure_dependent_friction", "cylinder", "friction", sizes.pressure, ("pressure_friction",), (), (),
              {"coefficient": "m^2"}, lambda m: {"coefficient": _about(m["pressure_friction"], 0.05)} if m["pressure_law"] == 0 else {}),
        Block("asymmetry", "asymmetric_friction", "cylinder", "friction",
              lambda d: {"asymmetry": float(d.rng.choice([-1.0, 1.0])) * d.between(0.12, 0.3) * min(d.bulk, 2.0)}, ("asymmetry",), (), (),
              {"forward": "N", "backward": "N"},
              lambda m: {"forward": _about(m["coulomb"] * (1 + m["asymmetry"]), 0.03),
                         "backward": _about(m["coulomb"] * (1 - m["asymmetry"]), 0.03)} if m["pressure_friction"] == 0 else {}),
        Block("heat", "wall_heat_transfer", "cylinder", "wall", sizes.heat, ("heat_conductance", "heat_coefficient"), (), (),
              {"conductance": "W/K"}, lambda m: {"conductance": _about(m["heat_conductance"], 0.02)} if m["heat_law"] == CONSTANT else {}),
        Block("wall", "moving_wall_temperature", "cylinder", "wall", sizes.wall, ("wall_capacity", "wall_outside")),
        Block("deadband", "valve_deadband", "cylinder", "valve", sizes.laps, ("lap_s1", "lap_e1", "lap_s2", "lap_e2"),
              ("valve_edges", "valve_overlap", "unequal_edges", "edge_overlap"), ("valve_offset",), {"width": "1"}, _laps_exact),
        Block("shift", "valve_offset", "cylinder", "valve",
              lambda d: {"shift": float(d.rng.choice([-1.0, 1.0])) * d.bulk * d.between(0.008, 0.03)}, ("shift",), (), (),
              {"shift": "1"}, lambda m: {"shift": _about(m["shift"], 0.02)}),
        Block("lag", "valve_lag", "cylinder", "valve", sizes.lag, ("lag", "lag_back", "spool_frequency", "spool_damping", "delay"),
              ("second_order_spool", "spool_dynamics", "valve_second_order"), ("spool_rate_limit",),
              {"time_constant": "s", "delay": "s"}, _lag_exact),
        Block("rate", "spool_rate_limit", "cylinder", "valve", lambda d: {"rate": d.between(15.0, 50.0) / d.bulk}, ("rate",), (),
              ("valve_lag",), {"rate": "1/s"}, lambda m: {"rate": _about(m["rate"], 0.05)}),
        Block("play", "valve_hysteresis", "cylinder", "valve", lambda d: {"play": d.bulk * d.between(0.008, 0.03)}, ("play",), (), (),
              {"width": "1"}, lambda m: {"width": _about(m["play"], 0.05)}),
        Block("null", "valve_null_leakage", "cylinder", "leak", lambda d: {"null_area": d.bulk * d.valve_area * d.between(0.003, 0.02)},
              ("null_area",), (), (), {"area": "m^2"}, lambda m: {"area": _about(m["null_area"], 0.05)}),
        Block("flow", "critical_ratio", "cylinder", "flow", sizes.flow, ("flow_law", "flow_b", "flow_m", "flow_laminar", "crack"),
              ("subsonic_index", "iso_6358", "flow_law", "iso6358_flow"), ("subsonic_index", "cracking_pressure"), {"ratio": "1"},
              lambda m: {"ratio": (m["flow_b"], m["flow_b"] - 0.02, m["flow_b"] + 0.02)}
              if m["flow_law"] == 0 and abs(m["flow_m"] - 0.5) < 0.02 and m["flow_laminar"] > 0.99 else {}),
        Block("hose", "line_restriction", "cylinder", "line", sizes.hose,
              ("hose_kind", "hose_area", "hose_b", "hose_volume", "hose_bore", "hose_length", "hose_heat"),
              ("transmission_line", "line_dynamics", "hose_line", "pneumatic_line"), (), {"area": "m^2", "volume": "m^3"}, _hose_exact),
        Block("leak_out", "external_leakage", "cylinder", "leak", sizes.leak_out, ("leak_1", "leak_2", "leak_inertial", "leak_turning"), (),
              (), _LEAK_UNITS,
              _leak_out_exact),
        Block("leak_piston", "piston_leakage", "cylinder", "leak", sizes.leak_piston, ("leak_piston", "leak_inertial", "leak_turning"),
              (), (), _LEAK_UNITS,
              _leak_piston_exact),
        Block("silencer", "exhaust_back_pressure", "exhaust", "line",
              lambda d: {"exhaust_area": d.valve_area * d.between(0.9, 2.2) / d.bulk, "exhaust_volume": d.decade(2e-5, 1e-4)},
              ("exhaust_area", "exhaust_volume"), (), (), {"area": "m^2"},
              lambda m: {"area": (m["exhaust_area"], 0.85 * m["exhaust_area"], 1.05 * m["exhaust_area"])}),
        Block("tank", "supply_droop", "supply", "supply",
              lambda d: {"tank_volume": d.size.area * d.stroke * d.between(8.0, 40.0) / d.bulk,
                         "tank_feed": d.valve_area * 0.00236 * d.between(0.6, 2.5), "tank_heat": d.between(0.2, 2.0)},
              ("tank_volume", "tank_feed", "tank_heat"), ("supply_regulator",), ("supply_regulator",)),
        Block("regulator", "supply_regulator", "supply", "supply",
              lambda d: {"regulator_droop": d.bulk * d.between(0.06, 0.25) * d.supply / (d.valve_area * 0.00236 * d.supply),
                         "regulator_time": d.between(0.02, 0.12), "regulator_overshoot": float(d.rng.choice([0.0, 0.5]))},
              ("regulator_droop", "regulator_time", "regulator_overshoot"), ("supply_droop",), ("supply_droop",), {"droop": "Pa s/kg"},
              lambda m: {"droop": _about(m["regulator_droop"], 0.05)}),
        Block("cushion", "end_cushioning", "cylinder", "line",
              lambda d: {"cushion_length": d.between(0.012, 0.022), "cushion_area": d.valve_area * d.between(0.05, 0.2)},
              ("cushion_length", "cushion_area"), ("cushion_seal",), (), {"length": "m"},
              lambda m: {"length": _about(m["cushion_length"], 0.05)}),
        Block("mount", "transmission_compliance", "cylinder", "transmission",
              lambda d: {"mount_stiffness": d.thrust / d.between(8e-4, 4e-3) / d.bulk},
              ("mount_stiffness", "mount_damping", "mount_gap"), ("backlash",), ("backlash",), {"stiffness": "N/m"},
              lambda m: {"stiffness": _about(m["mount_stiffness"], 0.05)}),
        Block("spring", "return_spring", "cylinder", "spring",
              lambda d: {"spring": d.bulk * d.between(0.06, 0.18) * d.thrust / d.stroke, "spring_rest": d.between(0.0, 0.4) * d.stroke},
              ("spring", "spring_rest"), (), (), {"stiffness": "N/m"}, lambda m: {"stiffness": _about(m["spring"], 0.03)}),
        Block("drag", "quadratic_drag", "cylinder", "friction", lambda d: {"drag": d.bulk * d.between(0.03, 0.1) * d.thrust}, ("drag",),
              (), (), {"coefficient": "N s^2/m^2"}, lambda m: {"coefficient": _about(m["drag"], 0.05)}),
        # outside the contract's list
        Block("place", "", "cylinder", "friction",
              lambda d: {"place_gain": d.between(0.3, 0.6), "place_pitch": d.stroke * d.between(0.8, 2.0),
                         "place_phase": d.between(0, 6.28)},
              ("place_gain", "place_pitch", "place_phase"), ("position_friction", "place_dependent_friction"), ("coulomb_friction",)),
        Block("dwell", "", "cylinder", "friction", lambda d: {"dwell_gain": d.between(0.25, 0.5) * d.bore_mm}, ("dwell_gain",),
              ("dwell_friction", "static_dwell", "rate_and_state_friction"), ("stribeck_friction", "coulomb_friction")),
        Block("warm", "", "cylinder", "friction",
              lambda d: {"warm_gain": d.between(0.5, 1.0), "warm_time": d.between(4.0, 10.0),
                         "warm_power": 0.02 * d.thrust * d.between(0.1, 0.3)},
              ("warm_gain", "warm_time", "warm_power"), ("warming_friction", "temperature_dependent_friction", "warming_grease"),
              ("coulomb_friction", "viscous_friction")),
        Block("relief", "", "cylinder", "leak",
              lambda d: {"relief_pressure": d.between(0.55, 0.75) * d.supply, "relief_gain": d.valve_area * d.between(0.1, 0.4) / 1e5},
              ("relief_pressure", "relief_gain"), ("relief_valve",), ()),
        Block("edges", "", "cylinder", "valve",
              lambda d: {"edge_e1": d.between(0.6, 0.8), "edge_e2": d.between(0.6, 0.8), "edge_s2": d.between(0.85, 1.0)},
              ("edge_s1", "edge_e1", "edge_s2", "edge_e2"),
              ("valve_edges", "unequal_edges", "metering_edges", "unequal_paths", "edge_areas"), ("flow_capacity",)),
        Block("curve", "", "cylinder", "valve", lambda d: {"curve": d.between(1.3, 1.7)}, ("curve",),
              ("valve_curve", "valve_characteristic", "spool_characteristic"), ("valve_deadband",)),
    )
}  # fmt: skip

#: What every real cylinder has.
SEAL = ("coulomb", "stribeck", "viscous")
#: What whole machines draw the rest of their effects from, with the chance that one is there at all.
COMMON = {"heat": 0.95, "deadband": 0.85, "lag": 0.85, "flow": 0.8, "hose": 0.6, "leak_out": 0.35, "leak_piston": 0.35}
OUTSIDE = ("place", "dwell", "warm", "relief", "edges", "curve")


def check_keys(keys: Sequence[str], known: Collection[str] = tuple(BLOCKS), of: str = "whole machines") -> None:
    """Check that effects can be hidden.

    Args:
        keys: Of effects that somebody asked for.
        known: Those that there are.
        of: What has them, for the message.

    Raises:
        TrialError: there is none of such a name.
    """
    for key in keys:
        if key not in known:
            raise TrialError(f'no effect "{key}" of {of}{nearest(key, known)}')
