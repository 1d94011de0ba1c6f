"""How large effects are on real machines: the fields of a machine, drawn for its make, its cylinder and its valve."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exo_sim.trials.whole_machines.gas_laws import CLEARANCE, CONSTANT, GAP, ORIFICE
from exo_sim.trials.whole_machines.make import Make
from exo_sim.trials.whole_machines.published_cylinders import HOSE_BORES, Size, hose_conductance, throat_area

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


def coulomb(d: Draft) -> Fields:
    return {"coulomb": d.bulk * d.between(0.25, 0.85) * d.bore_mm**1.03}


def stribeck(d: Draft) -> Fields:
    return {
        "breakaway_excess": d.bulk * d.between(0.35, 1.2) * 0.5 * d.bore_mm**1.03,
        "stribeck_speed": d.decade(8e-3, 6e-2),
        "stribeck_exponent": d.between(*d.make.laws.exponent),
    }


def viscous(d: Draft) -> Fields:
    index = d.between(*d.make.laws.viscous_index)
    return {"viscous": d.bulk * d.between(1.2, 4.5) * d.bore_mm, "viscous_index": index}


def pressure(d: Draft) -> Fields:
    # mu pi D w of a lip a third to one and a half millimetres wide; |p1 - p2| and the larger are smaller than the sum
    lip = d.bulk * d.between(0.12, 0.4) * math.pi * d.size.bore * d.between(3e-4, 1e-3)
    return {"pressure_friction": lip * (1.0 if d.make.laws.pressure == 0 else 2.0)}


def heat(d: Draft) -> Fields:
    coefficient = d.bulk * d.between(18.0, 75.0)
    if d.make.laws.heat == CONSTANT:
        wall = 2 * d.size.area + math.pi * d.size.bore * 0.5 * d.stroke
        return {"heat_conductance": coefficient * wall}
    return {"heat_coefficient": coefficient}


def wall(d: Draft) -> Fields:
    # aluminium of 2 to 3 mm around a half of the barrel, and an end cap
    barrel = math.pi * d.size.bore * 0.5 * d.stroke * d.between(2e-3, 3e-3) * 2700.0
    return {"wall_capacity": 900.0 * barrel * d.between(0.25, 0.8) / d.bulk, "wall_outside": 10.0 * math.pi * d.size.bore * d.stroke}


def laps(d: Draft) -> Fields:
    middle = d.bulk * d.between(0.015, 0.07)
    edges = [max(middle + d.between(-0.004, 0.004), 0.002) for _ in range(4)]
    if d.make.laws.unequal:
        edges = [max(middle * d.between(0.75, 1.25), 0.002) for _ in range(4)]
    return dict(zip(("lap_s1", "lap_e1", "lap_s2", "lap_e2"), edges))


def lag(d: Draft) -> Fields:
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


def flow(d: Draft) -> Fields:
    ratio = max(0.53 - d.bulk * d.between(0.08, 0.34), 0.12)
    laws = d.make.laws
    fields = {"flow_law": laws.flow, "flow_b": ratio, "flow_m": d.between(*laws.flow_m), "crack": d.between(*laws.crack)}
    return fields | ({"flow_laminar": d.between(*laws.laminar)} if laws.laminar else {})


def hose(d: Draft) -> Fields:
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


def leak_out(d: Draft) -> Fields:
    fields = _leak_size(d)
    size = fields.pop("leak")
    return {("leak_1" if d.rng.random() < 0.5 else "leak_2"): size, **fields}


def leak_piston(d: Draft) -> Fields:
    fields = _leak_size(d)
    return {"leak_piston": fields.pop("leak"), **fields}
