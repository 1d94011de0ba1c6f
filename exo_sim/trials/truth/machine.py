"""What the true machine is made of: the parts its owner knows of, and what is hidden in it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.81

#: Everything the compiled plant reads, all in SI. Zero means "not there" unless a comment says otherwise.
FIELDS = (
    # gas and surroundings
    "gas_constant", "heat_ratio", "ambient_pressure", "ambient_temperature", "supply_pressure", "supply_temperature",
    # cylinder
    "area_1", "area_2", "stroke", "dead_1", "dead_2", "piston_mass", "stop_stiffness", "stop_damping", "double_acting",
    # load
    "load_mass", "gravity", "spring_stiffness", "spring_rest", "damping", "dry_friction",
    # valve
    "valve_area", "choked_ratio", "leak_ratio", "laminar_zone", "deadband", "offset", "lag", "delay", "hysteresis",
    "rate_limit", "null_leak", "spool_frequency", "spool_damping",
    # heat
    "heat_conductance", "heat_eichelberg", "wall_capacity", "wall_outside",
    # leaks
    "leak_piston_area", "leak_piston_laminar", "leak_out_area_1", "leak_out_area_2",
    "leak_out_laminar_1", "leak_out_laminar_2", "leak_out_inertial",
    # lines, exhaust, supply
    "line_area", "line_volume", "line_inertance", "line_resistance", "exhaust_area", "exhaust_volume",
    "tank_volume", "tank_conductance", "regulator_droop", "regulator_time", "regulator_hysteresis",
    # friction
    "coulomb", "viscous", "stribeck_breakaway", "stribeck_velocity", "pressure_friction", "forward", "backward",
    "bristle_stiffness", "bristle_damping", "drag", "extra_stiffness", "extra_rest",
    # drive train
    "drive_stiffness", "drive_damping", "drive_gap",
    # cushioning
    "cushion_length", "cushion_area",
    # outside every list
    "relief_pressure", "relief_slope", "bump_force", "bump_place", "bump_width", "dwell_growth", "cogging_force",
    "cogging_pitch", "cogging_phase", "crack_pressure", "crack_area", "flow_force", "exhaust_ratio", "curve_exponent",
    "payload_change", "payload_time", "payload_ramp", "warm_extra", "warm_time", "detent_force", "detent_place",
    "detent_width",
)  # fmt: skip

DTYPE = np.dtype([(name, np.float64) for name in FIELDS])

_DEFAULTS = {
    "gas_constant": 287.05,
    "heat_ratio": 1.4,
    "ambient_pressure": 101325.0,
    "ambient_temperature": 293.15,
    "supply_pressure": 7e5,
    "supply_temperature": 293.15,
    "stop_stiffness": 3e6,
    "stop_damping": 2e3,
    "double_acting": 1.0,
    "choked_ratio": 0.5282817877,
    "leak_ratio": 0.5282817877,
    "laminar_zone": 3e-3,
    "piston_mass": 0.2,
    "exhaust_volume": 2e-5,
    "drive_damping": 0.0,
    "exhaust_ratio": 1.0,
    "curve_exponent": 1.0,
    "bristle_stiffness": 8e5,
    "bristle_damping": 600.0,
    "detent_width": 1.0,
    "bump_width": 1.0,
    "cogging_pitch": 1.0,
    "payload_ramp": 1.0,
    "warm_time": 1.0,
    "extra_rest": 0.0,
}


@dataclass(frozen=True)
class Machine:
    """One true machine.

    Attributes:
        values: Field name to SI number; fields left out take the defaults of a machine that obeys the paper.
    """

    values: Mapping[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        return float(self.values.get(name, _DEFAULTS.get(name, 0.0)))

    def with_(self, **changes: float) -> Machine:
        """Return a copy with some fields changed; an unknown field is a KeyError."""
        for name in changes:
            if name not in FIELDS:
                raise KeyError(name)
        return replace(self, values={**self.values, **changes})

    def is_default(self, name: str) -> bool:
        """Return whether a field is as in the paper's machine."""
        return self[name] == _DEFAULTS.get(name, 0.0)

    def packed(self) -> NDArray[np.void]:
        """Return the record that the compiled plant takes, shape (1,)."""
        record = np.zeros(1, DTYPE)
        for name in FIELDS:
            record[0][name] = self[name]
        return record

    def step(self) -> float:
        """Return the integration step [s] that the smallest gas volume of this machine allows."""
        volumes = [min(self["dead_1"], self["dead_2"]) + 0.1 * self["area_2"] * self["stroke"]]
        if self["line_area"] > 0 or self["line_inertance"] > 0:
            volumes.append(self["line_volume"])
        if self["exhaust_area"] > 0:
            volumes.append(self["exhaust_volume"])
        openings = self["valve_area"] + self["line_area"] + self["exhaust_area"]
        # slope of the flow law at equal pressures, d(mdot)/dP = A c / sqrt(T) * 2 / ((1 - b) sqrt(zone))
        slope = (
            openings * 0.0404 / math.sqrt(290.0) * 2 / ((1 - self["choked_ratio"]) * math.sqrt(self["laminar_zone"]))
        )
        rate = slope * 1.4 * 287.05 * 290.0 / min(volumes)
        # the piston between the gas and a stiff drive swings fast
        swing = math.sqrt(self["drive_stiffness"] / self["piston_mass"])
        for pieces in (1, 2, 4, 5, 10, 20):
            if 5e-5 / pieces * rate < 1.2 and 5e-5 / pieces * swing < 0.3:
                return 5e-5 / pieces
        return 1e-6
