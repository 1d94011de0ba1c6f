"""What a whole machine may hide: how large it is on real machines, which fields it sets, and what a right answer calls it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from exo_sim.trials.whole.catalogue import HOSE_BORES, Size, hose_conductance, throat_area
from exo_sim.trials.whole.gas_laws import CLEARANCE, CONSTANT, GAP, ORIFICE
from exo_sim.trials.whole.machine import Machine
from exo_sim.trials.whole.makes import Make

Fields = dict[str, float]


@dataclass(frozen=True)
class Draft:
    """A machine while it is drawn: its make, cylinder and sizes.

    Attributes:
        make, size, stroke: Which.
        supply: Absolute [Pa].
        valve_area: Throat area of each path [m^2].
        rng: Chance.
        bulk: Factor on the sizes of everything, 1 for real ones.
    """

    make: Make
    size: Size
    stroke: float
    supply: float
    valve_area: float
    rng: np.random.Generator
    bulk: float = 1.0

    def between(self, low: float, high: float) -> float:
        """Return a number drawn evenly."""
        return float(self.rng.uniform(low, high))

    def decade(self, low: float, high: float) -> float:
        """Return a number drawn evenly in its logarithm."""
        return math.exp(self.between(math.log(low), math.log(high)))

    @property
    def bore_mm(self) -> float:
        """Bore [mm]; what is published of seals is per millimetre."""
        return self.size.bore * 1e3

    @property
    def thrust(self) -> float:
        """Largest force of the gas [N]."""
        return (self.supply - 101325.0) * self.size.area


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


def _coulomb(d: Draft) -> Fields:
    return {"coulomb": d.bulk * d.between(0.25, 0.85) * d.bore_mm**1.03}


def _stribeck(d: Draft) -> Fields:
    return {
        "breakaway_excess": d.bulk * d.between(0.35, 1.2) * 0.5 * d.bore_mm**1.03,
        "stribeck_speed": d.decade(8e-3, 6e-2),
        "stribeck_exponent": d.between(*d.make.laws.exponent),
    }


def _viscous(d: Draft) -> Fields:
    index = d.between(*d.make.laws.viscous_index)
    return {"viscous": d.bulk * d.between(1.2, 4.5) * d.bore_mm, "viscous_index": index}


def _pressure(d: Draft) -> Fields:
    # mu pi D w of a lip a third to one and a half millimetres wide; |p1 - p2| and the larger are smaller than the sum
    lip = d.bulk * d.between(0.12, 0.4) * math.pi * d.size.bore * d.between(3e-4, 1e-3)
    return {"pressure_friction": lip * (1.0 if d.make.laws.pressure == 0 else 2.0)}


def _heat(d: Draft) -> Fields:
    coefficient = d.bulk * d.between(18.0, 75.0)
    if d.make.laws.heat == CONSTANT:
        wall = 2 * d.size.area + math.pi * d.size.bore * 0.5 * d.stroke
        return {"heat_conductance": coefficient * wall}
    return {"heat_coefficient": coefficient}


def _wall(d: Draft) -> Fields:
    # aluminium of 2 to 3 mm around a half of the barrel, and an end cap
    barrel = math.pi * d.size.bore * 0.5 * d.stroke * d.between(2e-3, 3e-3) * 2700.0
    return {"wall_capacity": 900.0 * barrel * d.between(0.25, 0.8) / d.bulk, "wall_outside": 10.0 * math.pi * d.size.bore * d.stroke}


def _laps(d: Draft) -> Fields:
    middle = d.bulk * d.between(0.015, 0.07)
    edges = [max(middle + d.between(-0.004, 0.004), 0.002) for _ in range(4)]
    if d.make.laws.unequal:
        edges = [max(middle * d.between(0.75, 1.25), 0.002) for _ in range(4)]
    return dict(zip(("lap_s1", "lap_e1", "lap_s2", "lap_e2"), edges))


def _lag(d: Draft) -> Fields:
    if d.make.laws.spool == "first":
        return {"lag": d.bulk * d.between(3e-3, 1.2e-2)}
    if d.make.laws.spool == "second":
        return {"spool_frequency": d.between(22.0, 70.0) / d.bulk, "spool_damping": d.between(0.6, 1.1)}
    if d.make.laws.spool == "piloted":
        delay = d.bulk * d.between(2e-3, 7e-3)
        return {"delay": delay, "spool_frequency": d.between(30.0, 80.0) / d.bulk, "spool_damping": d.between(0.5, 0.9)}
    if d.make.laws.spool == "uneven":
        lag = d.bulk * d.between(3e-3, 9e-3)
        return {"lag": lag, "lag_back": lag * d.between(1.4, 2.2)}
    return {"delay": d.bulk * d.between(4e-3, 1.4e-2), "lag": d.bulk * d.between(2e-3, 6e-3)}


def _flow(d: Draft) -> Fields:
    ratio = max(0.53 - d.bulk * d.between(0.08, 0.34), 0.12)
    laws = d.make.laws
    fields = {"flow_law": laws.flow, "flow_b": ratio, "flow_m": d.between(*laws.flow_m), "crack": d.between(*laws.crack)}
    return fields | ({"flow_laminar": d.between(*laws.laminar)} if laws.laminar else {})


def _hose(d: Draft) -> Fields:
    wanted = d.valve_area * d.between(1.0, 3.0) / d.bulk
    length = d.between(0.3, 1.6) if d.make.laws.hose == "node" else d.between(1.0, 3.0)
    bores = [bore for bore in HOSE_BORES if throat_area(hose_conductance(bore, length)[0]) > 0.8 * wanted]
    bore = bores[0] if bores else HOSE_BORES[-1]
    sonic, ratio = hose_conductance(bore, length)
    volume = 0.25 * math.pi * bore**2 * length
    if d.make.laws.hose == "line":
        return {"hose_kind": 2.0, "hose_bore": bore, "hose_length": length, "hose_heat": 3.0 * math.pi * bore * length * 4}
    return {"hose_kind": 1.0, "hose_area": throat_area(sonic), "hose_b": ratio, "hose_volume": volume, "hose_heat": 0.0}


def _leak_size(d: Draft) -> Fields:
    area = d.bulk * d.decade(6e-9, 6e-8) * d.bore_mm / 32.0
    # laminar paths are sized to pass as much at 6 bar against the room
    flow = area * 6e5 * 0.040418 / math.sqrt(293.15)
    squares = 6e5**2 - 1e5**2
    if d.make.laws.leak == ORIFICE:
        return {"leak": area}
    if d.make.laws.leak == GAP:
        return {"leak": flow / squares}
    if d.make.laws.leak == CLEARANCE:
        turning = flow * d.between(0.25, 0.7)
        return {"leak": turning * (flow / turning) ** 1.75 / squares, "leak_turning": turning}
    share = d.between(0.2, 0.6)  # of the drop that is inertial
    return {"leak": flow / (squares * (1.0 - share)), "leak_inertial": squares * share / flow**2}


def _leak_out(d: Draft) -> Fields:
    fields = _leak_size(d)
    size = fields.pop("leak")
    return {("leak_1" if d.rng.random() < 0.5 else "leak_2"): size, **fields}


def _leak_piston(d: Draft) -> Fields:
    fields = _leak_size(d)
    return {"leak_piston": fields.pop("leak"), **fields}


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
        Block("coulomb", "coulomb_friction", "cylinder", "friction", _coulomb, ("coulomb",), (), ("presliding",),
              {"force": "N"}, lambda m: {"force": _about(m["coulomb"], 0.03)}),
        Block("stribeck", "stribeck_friction", "cylinder", "friction", _stribeck,
              ("breakaway_excess", "stribeck_speed", "stribeck_exponent"), (), ("presliding",), {"breakaway": "N"},
              lambda m: {"breakaway": _about(m["coulomb"] + m["breakaway_excess"], 0.1)} if m["pressure_friction"] == 0 else {}),
        Block("viscous", "viscous_friction", "cylinder", "friction", _viscous, ("viscous", "viscous_index"), (), (),
              {"coefficient": "N*s/m"},
              lambda m: {"coefficient": _about(m["viscous"], 0.05)} if m["viscous_index"] == 1 else {}),  # a joint's damping is in the MJCF
        Block("pressure", "pressure_dependent_friction", "cylinder", "friction", _pressure, ("pressure_friction",), (), (),
              {"coefficient": "m^2"}, lambda m: {"coefficient": _about(m["pressure_friction"], 0.05)} if m["pressure_law"] == 0 else {}),
        Block("asymmetry", "asymmetric_friction", "cylinder", "friction",
              lambda d: {"asymmetry": float(d.rng.choice([-1.0, 1.0])) * d.between(0.12, 0.3) * min(d.bulk, 2.0)}, ("asymmetry",), (), (),
              {"forward": "N", "backward": "N"},
              lambda m: {"forward": _about(m["coulomb"] * (1 + m["asymmetry"]), 0.03),
                         "backward": _about(m["coulomb"] * (1 - m["asymmetry"]), 0.03)} if m["pressure_friction"] == 0 else {}),
        Block("heat", "wall_heat_transfer", "cylinder", "wall", _heat, ("heat_conductance", "heat_coefficient"), (), (),
              {"conductance": "W/K"}, lambda m: {"conductance": _about(m["heat_conductance"], 0.02)} if m["heat_law"] == CONSTANT else {}),
        Block("wall", "moving_wall_temperature", "cylinder", "wall", _wall, ("wall_capacity", "wall_outside")),
        Block("deadband", "valve_deadband", "cylinder", "valve", _laps, ("lap_s1", "lap_e1", "lap_s2", "lap_e2"),
              ("valve_edges", "valve_overlap", "unequal_edges", "edge_overlap"), ("valve_offset",), {"width": "1"}, _laps_exact),
        Block("shift", "valve_offset", "cylinder", "valve",
              lambda d: {"shift": float(d.rng.choice([-1.0, 1.0])) * d.bulk * d.between(0.008, 0.03)}, ("shift",), (), (),
              {"shift": "1"}, lambda m: {"shift": _about(m["shift"], 0.02)}),
        Block("lag", "valve_lag", "cylinder", "valve", _lag, ("lag", "lag_back", "spool_frequency", "spool_damping", "delay"),
              ("second_order_spool", "spool_dynamics", "valve_second_order"), ("spool_rate_limit",),
              {"time_constant": "s", "delay": "s"}, _lag_exact),
        Block("rate", "spool_rate_limit", "cylinder", "valve", lambda d: {"rate": d.between(15.0, 50.0) / d.bulk}, ("rate",), (),
              ("valve_lag",), {"rate": "1/s"}, lambda m: {"rate": _about(m["rate"], 0.05)}),
        Block("play", "valve_hysteresis", "cylinder", "valve", lambda d: {"play": d.bulk * d.between(0.008, 0.03)}, ("play",), (), (),
              {"width": "1"}, lambda m: {"width": _about(m["play"], 0.05)}),
        Block("null", "valve_null_leakage", "cylinder", "leak", lambda d: {"null_area": d.bulk * d.valve_area * d.between(0.003, 0.02)},
              ("null_area",), (), (), {"area": "m^2"}, lambda m: {"area": _about(m["null_area"], 0.05)}),
        Block("flow", "critical_ratio", "cylinder", "flow", _flow, ("flow_law", "flow_b", "flow_m", "flow_laminar", "crack"),
              ("subsonic_index", "iso_6358", "flow_law", "iso6358_flow"), ("subsonic_index", "cracking_pressure"), {"ratio": "1"},
              lambda m: {"ratio": (m["flow_b"], m["flow_b"] - 0.02, m["flow_b"] + 0.02)}
              if m["flow_law"] == 0 and abs(m["flow_m"] - 0.5) < 0.02 and m["flow_laminar"] > 0.99 else {}),
        Block("hose", "line_restriction", "cylinder", "line", _hose,
              ("hose_kind", "hose_area", "hose_b", "hose_volume", "hose_bore", "hose_length", "hose_heat"),
              ("transmission_line", "line_dynamics", "hose_line", "pneumatic_line"), (), {"area": "m^2", "volume": "m^3"}, _hose_exact),
        Block("leak_out", "external_leakage", "cylinder", "leak", _leak_out, ("leak_1", "leak_2", "leak_inertial", "leak_turning"), (),
              (), _LEAK_UNITS,
              _leak_out_exact),
        Block("leak_piston", "piston_leakage", "cylinder", "leak", _leak_piston, ("leak_piston", "leak_inertial", "leak_turning"),
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
