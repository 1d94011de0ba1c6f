"""Sizing by hand: the paper's design equations (35-39) with its example, and what its corrections change; then each joint."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exo_sim.physics import design_equations
from exo_sim.rig import Rig
from exo_sim.rig.catalogue import CATALOGUE, RATED_PRESSURE
from exo_sim.sizing.joint_kinds import JointKind
from exo_sim.sizing.length_and_arm import length_and_arm
from exo_sim.sizing.loads import JointLoads

_PSI, _INCH, _ATMOSPHERE = 6894.757293168361, 0.0254, 101325.0


@dataclass(frozen=True)
class Step:
    """One number by hand: what it is, its value in a unit, and where it comes from."""

    what: str
    value: float
    unit: str
    source: str


def papers_example() -> list[Step]:
    """Return one horsepower from 250 psi above the atmosphere: as printed, and what each correction makes of it."""
    p_0 = 250.0 * _PSI + _ATMOSPHERE
    half_gauge = 125.0 * _PSI + _ATMOSPHERE
    cubic = _INCH**3

    def flow(p_1: float, p_2: float, rod_share: float = 0.0) -> float:
        return design_equations.supply_flow(design_equations.HORSEPOWER, p_0, p_1, p_2, 1e-3, 1e-3 * (1.0 - rod_share), _ATMOSPHERE)

    q = flow(p_0, half_gauge)
    mass = design_equations.mass_flow(q, p_0, 293.15)
    work = design_equations.available_power(mass, p_0, 293.15)
    return [
        Step("supply flow, half of the gauge pressure as back-pressure", q / cubic, "in^3/s", "equation 39 as printed"),
        Step("with half of the absolute pressure instead", flow(p_0, 0.5 * p_0) / cubic, "in^3/s", "gauge or absolute"),
        Step("with a rod of a quarter of the bore's area", flow(p_0, half_gauge, 0.25) / cubic, "in^3/s",
             "areas that differ, atmosphere on the rod (equation 32)"),
        Step("with 10 % of the supply lost in the valve", flow(0.9 * p_0, half_gauge) / cubic, "in^3/s",
             "P1 below P0, which equation 38 takes as equal"),
        Step("the same flow as free air", 1e3 * design_equations.free_air(q, p_0), "L/s", "volume at 1 atm, not at 250 psi"),
        Step("as mass", 1e3 * mass, "g/s", "equation 36"),
        Step("smallest throat that passes it", 1e6 * design_equations.throat_area(mass, p_0, 293.15), "mm^2", "equation 30, exact"),
        Step("share of the work that the gas could do", 100.0 * design_equations.HORSEPOWER / work, "%", "1 hp over the exergy"),
        Step("exhaust temperature, enthalpy balance", design_equations.exhaust_temperature(293.15, p_0, half_gauge), "K",
             "equation 35 read as an energy balance would give 154.7 K"),
    ]  # fmt: skip


def joint_by_hand(rig: Rig, kind: JointKind, loads: JointLoads, supply: float | None = None) -> list[Step]:
    """Return the hand calculation for one kind of joint: force, bore, flow, throat, gas a cycle.

    Args:
        rig: The owner's machine; its linkage and atmosphere.
        kind: The joint.
        loads: What it must carry.
        supply: Absolute [Pa]; the rig's own, at most the catalogue's rating, when None.
    """
    p_a = rig.environment.pressure
    p_0 = min(rig.supply.pressure, RATED_PRESSURE + p_a) if supply is None else supply
    angle, speed, torque = loads.column(kind.joints[0])
    _, arm = length_and_arm(kind.own, kind.across, angle)
    force, rod_speed = torque / arm, arm * speed
    peak = int(np.argmax(np.abs(force)))
    power = float(np.mean(np.maximum(force * rod_speed, 0.0)))
    p_2 = 0.5 * p_0
    net = p_0 - p_2
    area = abs(float(force[peak])) / net
    bore = next((entry for entry in CATALOGUE if math.pi / 4 * entry.bore**2 >= area), CATALOGUE[-1])
    flow = design_equations.supply_flow(max(power, 1e-9), p_0, p_0, p_2, area, area, p_a)
    top = float(np.abs(rod_speed).max()) * math.pi / 4 * bore.bore**2
    mass_top = design_equations.mass_flow(top, p_0, rig.supply.temperature, rig.specific_gas_constant)
    mass = design_equations.mass_flow(flow, p_0, rig.supply.temperature, rig.specific_gas_constant)
    throat = design_equations.throat_area(mass_top, p_0, rig.supply.temperature, rig.heat_capacity_ratio, rig.specific_gas_constant)
    return [
        Step("largest torque", abs(float(torque[peak])), "N m", "the machine's own inverse dynamics"),
        Step("largest rod force", abs(float(force[peak])), "N", f"over an arm of {abs(1e3 * float(arm[peak])):.0f} mm"),
        Step("supply", p_0 / 1e5, "bar", "absolute"),
        Step("piston area at half the supply as back-pressure", 1e4 * area, "cm^2", "equation 32"),
        Step("bore of the catalogue", 1e3 * bore.bore, "mm", bore.standard),
        Step("mean power given", power, "W", "positive work only"),
        Step("mean supply flow", flow / _INCH**3, "in^3/s", "equation 38"),
        Step("gas a cycle, for that power", 1e3 * mass * loads.period, "g", "equation 36"),
        Step("throat for the fastest moment", 1e6 * throat, "mm^2", "equation 30, exact"),
    ]
