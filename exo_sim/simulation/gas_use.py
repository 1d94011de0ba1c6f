"""What the gas of a walk costs in a designer's numbers: free air, exergy, compressor, efficiency, bottle, tank, peak flow."""

from __future__ import annotations

from typing import Any

import numpy as np

from exo_sim.machine.linkage import linkages
from exo_sim.physics import compressed_air, real_air
from exo_sim.physics.compressed_air import Bottle
from exo_sim.rig import Rig
from exo_sim.simulation.running_statistics import Change, Least, Mean, Peak
from exo_sim.simulation.walk import Walk

#: A peak of flow is the mean over so long [s]: what a hose and a regulator feel.
PEAK_OVER = 0.02
#: How far the tank's pressure may sag within a cycle, of the supply's.
SAG = 0.05


#: Pressure dew points of ISO 8573-1 by its classes for water, the wettest first [C].
_DRY = ((4, 3.0), (3, -20.0), (2, -40.0), (1, -70.0))


def dryness(coldest: float) -> str:
    """Return how dry the air must be that no ice forms in gas as cold as this [K], by ISO 8573-1.

    The dew point at the supply's pressure counts: as gas expands its dew point falls, but slower than its temperature.

    >>> dryness(255.0)
    'dry to a pressure dew point below -18 C: class 3 of ISO 8573-1, 2 C to spare'
    """
    celsius = coldest - 273.15
    if celsius > 3.0:
        return "no ice with dew points of up to 3 C: class 4 of ISO 8573-1"
    found = next(((number, point) for number, point in _DRY if point < celsius), None)
    if found is None:
        return f"colder than the driest class of ISO 8573-1 ({_DRY[-1][1]:.0f} C): warm the chambers or count the heat of their walls"
    return f"dry to a pressure dew point below {celsius:.0f} C: class {found[0]} of ISO 8573-1, {celsius - found[1]:.0f} C to spare"


def measure(walk: Walk, rows: slice) -> dict[str, Any]:
    """Return what some rows of whole cycles draw and give, as reductions: masses [kg], work [W], flows [kg/s].

    What a recovery tank gains or loses meanwhile is taken off the mass drawn, or added to it.
    """
    part = {key: column[rows] for key, column in walk.columns.items()}
    drawn = np.sum([part[f"{name}.gas_used"] for name in walk.rig.cylinders], axis=0)
    driven = dict.fromkeys(link.joint for link in linkages(walk.rig, walk.model))
    power = [part[f"{name}.torque"] * part[f"{name}.velocity"] for name in driven]
    per_cycle = walk.motion.stride_time / walk.step
    cycles = len(drawn) / per_cycle
    over = min(max(1, round(PEAK_OVER / walk.step)), len(drawn) - 1)
    even = np.linspace(0.0, 1.0, len(drawn)) * (drawn[-1] - drawn[0])
    beyond = drawn - drawn[0] - even
    whole = [beyond[round(i * per_cycle) : round((i + 1) * per_cycle)] for i in range(max(1, int(cycles + 1e-6)))]
    held = part["recovery.gas"] if walk.rig.recovery is not None else np.zeros(len(drawn))
    out: dict[str, Any] = {
        "mass_kg_per_stride": Change(float(drawn[0] - held[0]), float(drawn[-1] - held[-1]), cycles),
        "positive_rod_work_w": Mean.of(np.sum(np.maximum(power, 0.0), axis=0)),
        "negative_rod_work_w": Mean.of(np.sum(np.minimum(power, 0.0), axis=0)),
        "peak_kg_per_s": Peak.of((drawn[over:] - drawn[:-over]) / (over * walk.step)),
        "swing_kg": Peak.of([np.ptp(piece) for piece in whole]),
        "chamber_temperature_least_k": Least.of([part[f"{name}.temperature_{side}"].min() for name, side in _chambers(walk.rig)]),
    }
    if walk.rig.recovery is not None:
        out["recovery"] = {
            "pressure_least_pa": Least.of([part["recovery.pressure"].min()]),
            "pressure_most_pa": Peak.of([part["recovery.pressure"].max()]),
            "gain_kg_per_stride": Change(float(held[0]), float(held[-1]), cycles),
        }
    return out


def _chambers(rig: Rig) -> list[tuple[str, int]]:
    """Return cylinder and number of every chamber."""
    return [(name, side) for name, c in rig.cylinders.items() for side in ((1,) if c.single_acting else (1, 2))]


def numbers(measured: dict[str, Any], rig: Rig, period: float, bottle: Bottle | None = None) -> dict[str, Any]:
    """Return the `gas` of the ledger from the values of what `measure` took.

    Args:
        measured: The values.
        rig: The machine; supply and surroundings.
        period: Of a cycle [s].
        bottle: 2 l of 300 bar when None.
    """
    bottle = bottle or Bottle(temperature=rig.environment.temperature)
    flow = measured["mass_kg_per_stride"] / period
    each = compressed_air.exergy(
        rig.supply.pressure, rig.environment.pressure, rig.environment.temperature, rig.specific_gas_constant
    )
    work = measured["positive_rod_work_w"]
    tank = compressed_air.tank_volume(
        measured["swing_kg"], SAG * rig.supply.pressure, rig.supply.temperature, rig.heat_capacity_ratio, rig.specific_gas_constant
    )
    out = {
        "free_air_l_per_min": 6e4 * compressed_air.free_air(flow),
        "mass_kg_per_s": flow,
        "mass_kg_per_stride": measured["mass_kg_per_stride"],
        "exergy_w": flow * each,
        "compressor": {
            "power_w": compressed_air.compressor_power(flow * each),
            "isothermal_efficiency": compressed_air.COMPRESSOR_EFFICIENCY,
        },
        "positive_rod_work_w": work,
        "negative_rod_work_w": measured["negative_rod_work_w"],
        "efficiency": work / (flow * each) if flow * each > 0.0 else 0.0,
        "least_kg_per_stride": work * period / each if each > 0.0 else 0.0,
        "peak_flow_l_per_min": 6e4 * compressed_air.free_air(measured["peak_kg_per_s"]),
        "tank": {"volume_l": 1e3 * tank, "sag_pa": SAG * rig.supply.pressure},
        "chamber_temperature_least_k": measured["chamber_temperature_least_k"],
    }
    if rig.recovery is not None:
        out["recovery"] = {"volume_l": 1e3 * rig.recovery.volume, **measured["recovery"]}
    if flow > 0.0 and _is_air(rig) and real_air.TEMPERATURES[0] <= bottle.temperature <= real_air.TEMPERATURES[1]:
        lasts = bottle.lasts(flow, rig.supply.pressure)
        out["bottle"] = {"volume_l": 1e3 * bottle.volume, "pressure_bar": bottle.pressure / 1e5, "lasts_s": lasts}
    return out


def _is_air(rig: Rig) -> bool:
    """Return whether the equation of state of air speaks of the rig's gas."""
    return abs(rig.specific_gas_constant * real_air.MOLAR_MASS / 8.31451 - 1.0) < 0.01


def rows(gas: dict[str, Any]) -> list[tuple[str, str]]:
    """Return the ledger of the gas as a table: what, and how much with its unit."""
    out = [
        ("free air (ISO 8778)", f"{gas['free_air_l_per_min']:.0f} l/min"),
        ("mass a cycle", f"{1e3 * gas['mass_kg_per_stride']:.2f} g"),
        (f"peak flow, over {1e3 * PEAK_OVER:.0f} ms", f"{gas['peak_flow_l_per_min']:.0f} l/min"),
        ("exergy of the gas", f"{gas['exergy_w']:.0f} W"),
        ("compressor, isothermal, "
         f"{100 * gas['compressor']['isothermal_efficiency']:.0f} %", f"{gas['compressor']['power_w']:.0f} W"),
        ("positive rod work", f"{gas['positive_rod_work_w']:.0f} W"),
        ("rod work over exergy", f"{100 * gas['efficiency']:.1f} %"),
        ("least by exergy: positive rod work, no loss", f"{1e3 * gas['least_kg_per_stride']:.2f} g a cycle"),
        ("rod work taken back, which is not counted there", f"{-gas['negative_rod_work_w']:.0f} W"),
        (f"tank that sags by {gas['tank']['sag_pa'] / 1e5:.2f} bar within a cycle", f"{gas['tank']['volume_l']:.2f} l"),
        ("coldest gas in a chamber", f"{gas['chamber_temperature_least_k'] - 273.15:.0f} C"),
        ("against ice", dryness(gas["chamber_temperature_least_k"])),
    ]
    if "recovery" in gas:
        out.append((f"recovery tank of {gas['recovery']['volume_l']:g} l", _recovery(gas["recovery"])))
    if "bottle" in gas:
        bottle = gas["bottle"]
        out.append((f"a bottle of {bottle['volume_l']:g} l and {bottle['pressure_bar']:g} bar lasts", f"{bottle['lasts_s']:.0f} s"))
    return out


def _recovery(tank: dict[str, Any]) -> str:
    return (
        f"{tank['pressure_least_pa'] / 1e5:.2f} to {tank['pressure_most_pa'] / 1e5:.2f} bar, gains "
        f"{1e3 * tank['gain_kg_per_stride']:.3f} g a cycle (taken off the mass above)"
    )


def words(gas: dict[str, Any]) -> list[str]:
    """Return the ledger of the gas in lines of text."""
    lines = [
        f"gas: {gas['free_air_l_per_min']:.0f} l/min of free air (ISO 8778), {1e3 * gas['mass_kg_per_stride']:.2f} g a cycle, "
        f"peak {gas['peak_flow_l_per_min']:.0f} l/min; exergy {gas['exergy_w']:.0f} W, of which "
        f"{100 * gas['efficiency']:.1f} % becomes rod work ({gas['positive_rod_work_w']:.0f} W); "
        f"least by exergy {1e3 * gas['least_kg_per_stride']:.2f} g",
        f"compressor {gas['compressor']['power_w']:.0f} W (isothermal, {100 * gas['compressor']['isothermal_efficiency']:.0f} %); tank "
        f"{gas['tank']['volume_l']:.2f} l for a sag of {gas['tank']['sag_pa'] / 1e5:.2f} bar; "
        f"coldest chamber {gas['chamber_temperature_least_k'] - 273.15:.0f} C: air {dryness(gas['chamber_temperature_least_k'])}",
    ]
    if "recovery" in gas:
        lines.append(f"recovery tank of {gas['recovery']['volume_l']:g} l: {_recovery(gas['recovery'])}")
    if "bottle" in gas:
        bottle = gas["bottle"]
        lines.append(f"a bottle of {bottle['volume_l']:g} l and {bottle['pressure_bar']:g} bar lasts {bottle['lasts_s']:.0f} s")
    return lines
