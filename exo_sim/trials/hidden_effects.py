"""What can be hidden in the true bench: listed effects, things outside the list, sensors and believed numbers.

An effect's `size` is 1 at a clearly visible size and goes to 0 where it vanishes; parameters that are not its
strength (a rest length, a Stribeck velocity) are drawn once a case and do not change with size.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from exo_sim.errors import TrialError, nearest
from exo_sim.trials.truth.bench import CYLINDER, JOINT, Bench
from exo_sim.trials.truth.machine import Machine

Parameters = dict[str, float]
#: Chance to a number in a range, drawn uniformly.
Draw = Callable[[float, float], float]


@dataclass(frozen=True)
class Effect:
    """One thing that can be hidden.

    Attributes:
        name: Its public name, or its own for what is outside the list.
        variant: Distinguishes forms of one effect; "" where there is one.
        where: Where it is planted; a sensor column for sensor effects.
        kind: "missing_physics", "calibration", "sensor" or "outside".
        units: Parameter to unit.
        parameters: Bench, draw and size to parameter values.
        fields: Parameters to fields of the true machine; empty for sensor effects.
        known: Effects that the owner must know of for this one to make sense.
        reach: Share of half the stroke that the motion must use.
        synonyms: Other places or names that are the same physics on this bench.
        healthy: Size that a bench of a careful laboratory has of it, one standard deviation.
        smallest: Size below which the plant cannot be integrated in reasonable steps.
        largest: Size above which the machine stops being one.
    """

    name: str
    where: str
    kind: str
    units: Mapping[str, str]
    parameters: Callable[[Bench, Draw, float], Parameters]
    fields: Callable[[Bench, Parameters], Parameters] = lambda bench, p: {}
    variant: str = ""
    known: tuple[str, ...] = ()
    reach: float = 0.7
    synonyms: tuple[str, ...] = ()
    healthy: float = 0.025
    smallest: float = 1e-4
    largest: float = 4.0

    @property
    def key(self) -> str:
        """Name and variant, as the command line takes it."""
        return f"{self.name}:{self.variant}" if self.variant else self.name


@dataclass(frozen=True)
class Hidden:
    """One effect at one size in one bench."""

    effect: Effect
    size: float
    parameters: Parameters = field(default_factory=dict)

    def into(self, machine: Machine, bench: Bench) -> Machine:
        """Return the machine with this effect in it; forces and areas of several effects do not mask each other."""
        return machine.with_(**self.effect.fields(bench, self.parameters))


def plant(effect: Effect, bench: Bench, size: float, seed: int) -> Hidden:
    """Return the effect at a size. The same seed gives the same shape at every size."""
    rng = np.random.default_rng(seed)
    parameters = effect.parameters(bench, lambda low, high: float(rng.uniform(low, high)), size)
    return Hidden(effect, size, parameters)


def _flow(bench: Bench) -> float:
    """Choked flow at full command from supply [kg/s], a scale."""
    return bench.valve_area * 0.0404 * bench.supply / np.sqrt(bench.temperature)


P = CYLINDER
_TABLE: tuple[Effect, ...] = (
    # gas and leaks
    Effect("wall_heat_transfer", P, "missing_physics", {"conductance": "W/K"},
           lambda b, d, s: {"conductance": s * d(0.6, 1.2) * 0.5 * b.volume / 7e-5},
           lambda b, p: {"heat_conductance": p["conductance"]}),
    Effect("moving_wall_temperature", P, "missing_physics", {"heat_capacity": "J/K", "outside_conductance": "W/K"},
           lambda b, d, s: {"heat_capacity": d(1.5, 3.0) * b.volume / 7e-5 / s,
                            "outside_conductance": d(0.1, 0.2) * b.volume / 7e-5},
           lambda b, p: {"wall_capacity": p["heat_capacity"], "wall_outside": p["outside_conductance"]},
           known=("wall_heat_transfer",)),
    Effect("piston_leakage", P, "missing_physics", {"area": "m^2"},
           lambda b, d, s: {"area": s * d(0.6, 1.4) * 2e-8 * b.volume / 7e-5},
           lambda b, p: {"leak_piston_area": p["area"]}),
    Effect("piston_leakage", P, "missing_physics", {"laminar": "kg/(s Pa^2)"},
           lambda b, d, s: {"laminar": s * d(0.6, 1.4) * 2e-16 * b.volume / 7e-5},
           lambda b, p: {"leak_piston_laminar": p["laminar"]}, variant="laminar"),
    Effect("external_leakage", P, "missing_physics", {"area_1": "m^2"},
           lambda b, d, s: {"area_1": s * d(0.6, 1.4) * 1e-8 * b.volume / 7e-5},
           lambda b, p: {"leak_out_area_1": p["area_1"]}),
    Effect("external_leakage", P, "missing_physics", {"area_2": "m^2"},
           lambda b, d, s: {"area_2": s * d(0.6, 1.4) * 1e-8 * b.volume / 7e-5},
           lambda b, p: {"leak_out_area_2": p["area_2"]}, variant="chamber_2"),
    Effect("external_leakage", P, "missing_physics",
           {"laminar_1": "kg/(s Pa^2)", "laminar_2": "kg/(s Pa^2)", "inertial": "Pa^2 s^2/kg^2"},
           lambda b, d, s: {"laminar_1": s * d(0.6, 1.4) * 1e-16 * b.volume / 7e-5,
               "laminar_2": s * 2e-17 * b.volume / 7e-5,
                            "inertial": d(0.5, 1.5) * 4e20 / (s * b.volume / 7e-5) ** 2},
           lambda b, p: {"leak_out_laminar_1": p["laminar_1"], "leak_out_laminar_2": p["laminar_2"],
                         "leak_out_inertial": p["inertial"]}, variant="porous"),
    # valve
    Effect("valve_null_leakage", P, "missing_physics", {"area": "m^2"},
           lambda b, d, s: {"area": s * d(0.6, 1.4) * 1.5e-8 * b.volume / 7e-5}, lambda b, p: {"null_leak": p["area"]}),
    Effect("valve_deadband", P, "missing_physics", {"width": "1"},
           lambda b, d, s: {"width": s * d(0.02, 0.05)}, lambda b, p: {"deadband": p["width"]}),
    Effect("valve_offset", P, "missing_physics", {"shift": "1"},
           lambda b, d, s: {"shift": s * d(0.01, 0.025) * (1 if d(-1, 1) > 0 else -1)},
           lambda b, p: {"offset": p["shift"]}),
    Effect("valve_lag", P, "missing_physics", {"time_constant": "s", "delay": "s"},
           lambda b, d, s: {"time_constant": s * d(6e-3, 15e-3), "delay": 0.0},
           lambda b, p: {"lag": p["time_constant"], "delay": p["delay"]}),
    Effect("valve_lag", P, "missing_physics", {"time_constant": "s", "delay": "s"},
           lambda b, d, s: {"time_constant": s * d(3e-3, 8e-3), "delay": s * d(4e-3, 10e-3)},
           lambda b, p: {"lag": p["time_constant"], "delay": p["delay"]}, variant="delay"),
    Effect("valve_hysteresis", P, "missing_physics", {"width": "1"},
           lambda b, d, s: {"width": s * d(0.02, 0.05)}, lambda b, p: {"hysteresis": p["width"]}),
    Effect("spool_rate_limit", P, "missing_physics", {"rate": "1/s"},
           lambda b, d, s: {"rate": d(3.0, 5.0) / s}, lambda b, p: {"rate_limit": p["rate"]}),
    Effect("critical_ratio", P, "missing_physics", {"ratio": "1"},
           lambda b, d, s: {"ratio": max(0.5282817877 - s * d(0.15, 0.3), 0.02)},
           lambda b, p: {"choked_ratio": p["ratio"]}),
    # lines, exhaust, supply
    Effect("line_restriction", P, "missing_physics", {"area": "m^2", "volume": "m^3"},
           lambda b, d, s: {"area": d(0.25, 0.45) * b.valve_area / s, "volume": d(0.3, 0.5) * min(b.dead_1, b.dead_2)},
           lambda b, p: {"line_area": p["area"], "line_volume": p["volume"]}, smallest=0.05),
    Effect("line_restriction", P, "missing_physics", {"area": "m^2", "volume": "m^3", "sensor_at_valve": "1"},
           lambda b, d, s: {"area": d(0.25, 0.45) * b.valve_area / s, "volume": d(0.3, 0.5) * min(b.dead_1, b.dead_2),
                            "sensor_at_valve": 1.0},
           lambda b, p: {"line_area": p["area"], "line_volume": p["volume"]}, variant="valve_end", smallest=0.05),
    Effect("exhaust_back_pressure", "exhaust", "missing_physics", {"area": "m^2"},
           lambda b, d, s: {"area": d(0.06, 0.12) * b.valve_area / s}, lambda b, p: {"exhaust_area": p["area"]},
           synonyms=(P,), smallest=0.02),
    Effect("supply_droop", "supply", "missing_physics", {"volume": "m^3", "conductance": "kg/(s Pa)"},
           lambda b, d, s: {"volume": d(2e-4, 5e-4) / s, "conductance": 0.1 * _flow(b) / (d(0.3, 0.7) * 1e5) / s},
           lambda b, p: {"tank_volume": p["volume"], "tank_conductance": p["conductance"]}),
    Effect("supply_regulator", "supply", "missing_physics",
           {"droop": "Pa s/kg", "time_constant": "s", "hysteresis": "Pa"},
           lambda b, d, s: {"droop": s * d(0.3, 0.6) * 1e5 / (0.1 * _flow(b)), "time_constant": d(0.03, 0.1),
                            "hysteresis": s * d(0.5e4, 1.5e4)},
           lambda b, p: {"regulator_droop": p["droop"], "regulator_time": p["time_constant"],
                         "regulator_hysteresis": p["hysteresis"]}),
    Effect("end_cushioning", P, "missing_physics", {"length": "m", "area": "m^2"},
           lambda b, d, s: {"length": d(0.15, 0.22) * b.stroke, "area": d(0.03, 0.06) * b.valve_area / s},
           lambda b, p: {"cushion_length": p["length"], "cushion_area": p["area"]}, reach=0.88),
    # friction and forces
    Effect("coulomb_friction", P, "missing_physics", {"force": "N"},
           lambda b, d, s: {"force": s * d(0.02, 0.04) * b.stall}, lambda b, p: {"coulomb": p["force"]},
           synonyms=(JOINT,)),
    Effect("viscous_friction", P, "missing_physics", {"coefficient": "N*s/m"},
           lambda b, d, s: {"coefficient": s * d(0.5, 1.2) * b.damping}, lambda b, p: {"viscous": p["coefficient"]},
           synonyms=(JOINT,)),
    Effect("stribeck_friction", P, "missing_physics", {"breakaway": "N", "velocity": "m/s"},
           lambda b, d, s: {"breakaway": b.known["coulomb_friction", P]["force"] * (1 + s * d(0.5, 1.0)),
                            "velocity": d(0.02, 0.06)},
           lambda b, p: {"stribeck_breakaway": p["breakaway"], "stribeck_velocity": p["velocity"]},
           known=("coulomb_friction",), synonyms=(JOINT,)),
    Effect("pressure_dependent_friction", P, "missing_physics", {"coefficient": "m^2"},
           lambda b, d, s: {"coefficient": s * d(0.02, 0.04) * b.area_1},
           lambda b, p: {"pressure_friction": p["coefficient"]}),
    Effect("asymmetric_friction", P, "missing_physics", {"forward": "N", "backward": "N"},
           lambda b, d, s: dict(zip(("forward", "backward") if d(0, 1) > 0.5 else ("backward", "forward"),
                                    (s * d(0.03, 0.045) * b.stall, s * d(0.01, 0.018) * b.stall))),
           lambda b, p: {"forward": p["forward"], "backward": p["backward"]}, synonyms=(JOINT,)),
    Effect("presliding", P, "missing_physics", {"stiffness": "N/m", "damping": "N*s/m"},
           lambda b, d, s: {"stiffness": d(1.0, 2.0) * b.gas_stiffness / s,
                            "damping": d(0.2, 0.4) * np.sqrt(b.gas_stiffness * b.mass)},
           lambda b, p: {"bristle_stiffness": p["stiffness"], "bristle_damping": p["damping"]},
           known=("coulomb_friction",), synonyms=(JOINT,), smallest=0.01),
    Effect("quadratic_drag", P, "missing_physics", {"coefficient": "N*s^2/m^2"},
           lambda b, d, s: {"coefficient": s * d(0.5, 1.0) * 0.03 * b.stall / 0.04},
           lambda b, p: {"drag": p["coefficient"]},
           synonyms=(JOINT,)),
    Effect("return_spring", P, "missing_physics", {"stiffness": "N/m", "rest": "m"},
           lambda b, d, s: {"stiffness": s * d(0.05, 0.12) * b.stall / b.stroke * 2, "rest": d(0.1, 0.9) * b.stroke},
           lambda b, p: {"extra_stiffness": p["stiffness"], "extra_rest": p["rest"]}, synonyms=(JOINT,)),
    Effect("transmission_compliance", P, "missing_physics", {"stiffness": "N/m"},
           lambda b, d, s: {"stiffness": d(4.0, 8.0) * b.gas_stiffness / s},
           lambda b, p: {"drive_stiffness": p["stiffness"],
               "drive_damping": 0.1 * np.sqrt(p["stiffness"] * 0.03 * b.mass)},
           synonyms=(JOINT,), smallest=0.01),
    Effect("backlash", JOINT, "missing_physics", {"gap": "m"},
           lambda b, d, s: {"gap": s * d(0.4e-3, 1.0e-3)},
           lambda b, p: {"drive_stiffness": 100 * b.gas_stiffness, "drive_gap": p["gap"],
                         "drive_damping": 0.3 * np.sqrt(100 * b.gas_stiffness * 0.03 * b.mass)}, synonyms=(P,)),
    # believed numbers
    Effect("flow_capacity", P, "calibration", {"factor": "1"},
           lambda b, d, s: {"factor": 1 + s * d(0.15, 0.3) * (1 if d(-1, 1) > 0 else -1)},
           lambda b, p: {"valve_area": b.valve_area * p["factor"]}, healthy=0.09, largest=1.5),
    Effect("dead_volume", P, "calibration", {"factor": "1"},
           lambda b, d, s: {"factor": max(1 + s * d(0.4, 0.7) * (1 if d(-1, 1) > -0.3 else -1), 0.1)},
           lambda b, p: {"dead_1": b.dead_1 * p["factor"], "dead_2": b.dead_2 * p["factor"]},
           healthy=0.09, largest=1.5),
    Effect("payload_mass", JOINT, "calibration", {"factor": "1"},
           lambda b, d, s: {"factor": 1 + s * d(0.08, 0.2) * (1 if d(-1, 1) > 0 else -0.7)},
           lambda b, p: {"load_mass": b.mass * p["factor"]}, healthy=0.036, largest=1.5),
    # sensors
    Effect("sensor_delay", f"{P}.pressure_1", "sensor", {"seconds": "s"},
           lambda b, d, s: {"seconds": s * d(3e-3, 8e-3)}),
    Effect("sensor_delay", f"{JOINT}.position", "sensor", {"seconds": "s"},
           lambda b, d, s: {"seconds": s * d(3e-3, 8e-3)},
           variant="position"),
    Effect("sensor_bias", f"{P}.pressure_2", "sensor", {"value": "Pa"},
           lambda b, d, s: {"value": s * d(5e3, 1.5e4) * (1 if d(-1, 1) > 0 else -1)}),
    Effect("sensor_scale", f"{P}.pressure_1", "sensor", {"factor": "1"},
           lambda b, d, s: {"factor": 1 + s * d(0.02, 0.05) * (1 if d(-1, 1) > 0 else -1)}),
    Effect("sensor_gauge", f"{P}.pressure_1", "sensor", {"value": "Pa"}, lambda b, d, s: {"value": -b.ambient},
           synonyms=("sensor_bias",)),
    # outside the list
    Effect("relief_valve", P, "outside", {"pressure": "Pa", "slope": "m^2/Pa"},
           lambda b, d, s: {"pressure": d(0.62, 0.7) * b.supply, "slope": s * d(0.5, 1.5) * 2e-12 * b.volume / 7e-5},
           lambda b, p: {"relief_pressure": p["pressure"], "relief_slope": p["slope"]}),
    Effect("position_friction", P, "outside", {"force": "N", "place": "m", "width": "m"},
           lambda b, d, s: {"force": s * d(0.05, 0.09) * b.stall, "place": d(0.35, 0.65) * b.stroke,
               "width": d(0.05, 0.09) * b.stroke},
           lambda b, p: {"bump_force": p["force"], "bump_place": p["place"], "bump_width": p["width"]}),
    Effect("dwell_friction", P, "outside", {"growth": "N"},
           lambda b, d, s: {"growth": s * d(0.05, 0.09) * b.stall}, lambda b, p: {"dwell_growth": p["growth"]},
           known=("coulomb_friction",)),
    Effect("cogging", P, "outside", {"force": "N", "pitch": "m", "phase": "rad"},
           lambda b, d, s: {"force": s * d(0.03, 0.06) * b.stall, "pitch": d(0.012, 0.03), "phase": d(0, 6.28)},
           lambda b, p: {"cogging_force": p["force"], "cogging_pitch": p["pitch"], "cogging_phase": p["phase"]}),
    Effect("cracking_leak", P, "outside", {"pressure": "Pa", "area": "m^2"},
           lambda b, d, s: {"pressure": d(0.0, 2e4), "area": s * d(0.6, 1.4) * 1e-7 * b.volume / 7e-5},
           lambda b, p: {"crack_pressure": p["pressure"], "crack_area": p["area"]}),
    Effect("flow_force", P, "outside", {"gain": "1/MPa"},
           lambda b, d, s: {"gain": s * d(0.5, 0.9)}, lambda b, p: {"flow_force": p["gain"]}),
    Effect("ringing_hose", P, "outside", {"inertance": "1/m", "volume": "m^3", "resistance": "1/s"},
           lambda b, d, s: {"inertance": s * d(0.5, 1.5) / 1.26e-5, "volume": 0.4 * min(b.dead_1, b.dead_2),
               "resistance": d(20, 60)},
           lambda b, p: {"line_inertance": p["inertance"], "line_volume": p["volume"],
               "line_resistance": p["resistance"]}, smallest=0.02),
    Effect("draining_payload", JOINT, "outside", {"change": "kg", "start": "s", "ramp": "s"},
           lambda b, d, s: {"change": -s * d(0.3, 0.45) * b.mass, "start": d(4, 9), "ramp": d(2, 6)},
           lambda b, p: {"payload_change": p["change"], "payload_time": p["start"], "payload_ramp": p["ramp"]}),
    Effect("warming_grease", P, "outside", {"extra": "N*s/m", "time": "s"},
           lambda b, d, s: {"extra": s * d(1.2, 2.0) * b.damping, "time": d(4, 8)},
           lambda b, p: {"warm_extra": p["extra"], "warm_time": p["time"]}),
    Effect("magnetic_detent", P, "outside", {"force": "N", "place": "m", "width": "m"},
           lambda b, d, s: {"force": s * d(0.05, 0.09) * b.stall, "place": d(0.4, 0.6) * b.stroke,
               "width": d(0.02, 0.05) * b.stroke},
           lambda b, p: {"detent_force": p["force"], "detent_place": p["place"], "detent_width": p["width"]}),
    Effect("unequal_paths", P, "outside", {"ratio": "1"},
           lambda b, d, s: {"ratio": max(1 - s * d(0.25, 0.4), 0.1)}, lambda b, p: {"exhaust_ratio": p["ratio"]}),
    Effect("curved_valve", P, "outside", {"exponent": "1"},
           lambda b, d, s: {"exponent": 1 + s * d(0.25, 0.5)}, lambda b, p: {"curve_exponent": p["exponent"]}),
)  # fmt: skip

EFFECTS = {effect.key: effect for effect in _TABLE}
LISTED = tuple(key for key, effect in EFFECTS.items() if effect.kind == "missing_physics")
OUTSIDE = tuple(key for key, effect in EFFECTS.items() if effect.kind == "outside")
SENSORS = tuple(key for key, effect in EFFECTS.items() if effect.kind == "sensor")
CALIBRATIONS = tuple(key for key, effect in EFFECTS.items() if effect.kind == "calibration")


def find(key: str) -> Effect:
    """Return an effect by its key.

    Raises:
        TrialError: there is none of this name.
    """
    if key not in EFFECTS:
        raise TrialError(f'no effect "{key}"{nearest(key, EFFECTS)}')
    return EFFECTS[key]
