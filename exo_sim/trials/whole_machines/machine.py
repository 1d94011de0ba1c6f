"""The numbers of one true machine."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

#: All in SI; laws are numbers of `gas_laws` and `friction_laws`. Zero means "not there" unless a default says otherwise.
FIELDS = (
    # gas and surroundings
    "gas_constant", "heat_ratio", "sonic", "ambient", "room",
    # cylinder
    "area_1", "area_2", "stroke", "dead_1", "dead_2", "single_acting", "piston_mass", "stop_stiffness", "stop_damping",
    # load: a slide (inertia in kg) or a lever (in kg m^2), free or led by its wearer
    "led", "lever", "inertia", "gravity", "damping", "zero", "lever_arm", "lever_base", "lever_angle", "lever_length",
    "spring", "spring_rest", "drag",
    # mount
    "mount_stiffness", "mount_damping", "mount_gap",
    # supply and exhaust
    "supply", "tank_volume", "tank_feed", "tank_heat", "regulator_droop", "regulator_time", "regulator_overshoot",
    "exhaust_area", "exhaust_volume",
    # valve: edges are supply to 1, 1 to exhaust, supply to 2, 2 to exhaust
    "valve_area", "edge_s1", "edge_e1", "edge_s2", "edge_e2", "lap_s1", "lap_e1", "lap_s2", "lap_e2", "shift", "null_area",
    "lag", "lag_back", "spool_frequency", "spool_damping", "delay", "rate", "play", "curve", "flow_law", "flow_b", "flow_m",
    "flow_laminar", "crack",
    # hose
    "hose_kind", "hose_area", "hose_b", "hose_volume", "hose_bore", "hose_length", "hose_heat",
    # leaks
    "leak_law", "leak_piston", "leak_1", "leak_2", "leak_inertial", "leak_turning", "relief_pressure", "relief_gain",
    # heat
    "heat_law", "heat_conductance", "heat_coefficient", "wall_capacity", "wall_outside",
    # cushion
    "cushion_length", "cushion_area",
    # friction
    "contact_law", "stribeck_law", "pressure_law", "coulomb", "breakaway_excess", "stribeck_speed", "stribeck_exponent",
    "viscous", "viscous_index", "pressure_friction", "asymmetry", "smooth_speed", "bristle_stiffness", "bristle_damping",
    "place_gain", "place_pitch", "place_phase", "dwell_gain", "warm_gain", "warm_time", "warm_power",
)  # fmt: skip

DTYPE = np.dtype([(name, np.float64) for name in FIELDS])

_DEFAULTS = {
    "gas_constant": 287.05,
    "heat_ratio": 1.4,
    "ambient": 101325.0,
    "room": 293.15,
    "stop_stiffness": 5e5,
    "stop_damping": 4e2,
    "edge_s1": 1.0,
    "edge_e1": 1.0,
    "edge_s2": 1.0,
    "edge_e2": 1.0,
    "curve": 1.0,
    "flow_law": 1.0,  # the nozzle
    "flow_b": 0.5282817877171742,
    "flow_m": 0.5,
    "flow_laminar": 0.998,
    "hose_b": 0.4,
    "exhaust_volume": 3e-5,
    "leak_inertial": 1e20,
    "leak_turning": 1.0,
    "stribeck_speed": 0.02,
    "stribeck_exponent": 1.0,
    "viscous_index": 1.0,
    "smooth_speed": 1e-3,
    "bristle_stiffness": 1e5,
    "place_pitch": 1.0,
    "warm_time": 1.0,
    "warm_power": 1.0,
    "regulator_time": 0.05,
}


@dataclass(frozen=True)
class Machine:
    """One true machine.

    Attributes:
        values: Field to SI number; what is left out takes the default of a machine without losses.
    """

    values: Mapping[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        if name == "sonic":
            return self._sonic()
        return float(self.values.get(name, _DEFAULTS.get(name, 0.0)))

    def with_(self, **changes: float) -> Machine:
        """Return a copy with some fields changed; an unknown field is a KeyError."""
        for name in changes:
            if name not in FIELDS:
                raise KeyError(name)
        return replace(self, values={**self.values, **changes})

    def without(self, *names: str) -> Machine:
        """Return a copy with some fields back at their defaults."""
        return replace(self, values={key: value for key, value in self.values.items() if key not in names})

    def packed(self) -> NDArray[np.void]:
        """Return the record that the compiled plant takes, shape (1,)."""
        record = np.zeros(1, DTYPE)
        for name in FIELDS:
            record[0][name] = self[name]
        return record

    @property
    def moved_mass(self) -> float:
        """What the piston moves, itself included [kg]; a lever's inertia is taken at its mean arm."""
        if self["lever"] == 0.0:
            return self["inertia"] + (self["piston_mass"] if self["mount_stiffness"] == 0.0 else 0.0)
        return self["inertia"] / (0.8 * self["lever_arm"]) ** 2 + self["piston_mass"]

    def step(self, most: float = 2e-5) -> float:
        """Return an integration step [s] that the fastest part of this machine bears, a divisor of 1e-4."""
        rates = [*self._gas_rates(), *self._contact_rates()]
        bound = 1.2 / max(rates)
        for pieces in (5, 10, 20, 25, 40, 50, 80, 100):
            if 1e-4 / pieces <= min(bound, most):
                return 1e-4 / pieces
        return 1e-6

    def _sonic(self) -> float:
        k, r = self["heat_ratio"], self["gas_constant"]
        return math.sqrt(k / r) * (2.0 / (k + 1.0)) ** ((k + 1.0) / (2.0 * (k - 1.0)))

    def _gas_rates(self) -> list[float]:
        # slope of the flow law at equal pressures over the volume behind it
        slope = 50.0 * self._sonic() / math.sqrt(self["room"]) * self["heat_ratio"] * self["gas_constant"] * self["room"]
        chambers = min(self["dead_1"], self["dead_2"])
        openings = self["valve_area"]
        rates = []
        if self["hose_kind"] == 1.0:
            rates += [slope * (openings + self["hose_area"]) / self["hose_volume"], slope * self["hose_area"] / chambers]
        elif self["hose_kind"] == 2.0:
            cell = self["hose_bore"] ** 2 * math.pi / 4 * self["hose_length"] / 3
            rates += [slope * openings / cell, 6 * 343.0 / self["hose_length"]]
        else:
            rates.append(slope * openings / chambers)
        if self["exhaust_area"] > 0:
            rates.append(slope * (openings + self["exhaust_area"]) / self["exhaust_volume"])
        return rates

    def _contact_rates(self) -> list[float]:
        mass = self["piston_mass"] if self["mount_stiffness"] > 0 else self.moved_mass
        peak = (self["coulomb"] + self["breakaway_excess"] + self["pressure_friction"] * 1.2e6) * (1 + abs(self["asymmetry"]))
        rates = [math.sqrt((self["stop_stiffness"] + self["mount_stiffness"]) / mass), self["stop_damping"] / mass]
        rates.append((self["viscous"] + self["mount_damping"]) / mass)
        if peak > 0 and self["contact_law"] == 0.0:
            rates.append(peak / self["smooth_speed"] / mass)
        elif peak > 0:
            rates.append(1.5 * self["bristle_stiffness"] / max(self["coulomb"], 1e-3))
            rates.append(self["bristle_damping"] / mass + math.sqrt(self["bristle_stiffness"] / mass))
        if self["spool_frequency"] > 0:
            rates.append(2 * math.pi * self["spool_frequency"] * 1.5)
        if self["lag"] > 0:
            rates.append(1.0 / (min(self["lag"], self["lag_back"]) or self["lag"]))
        return rates
