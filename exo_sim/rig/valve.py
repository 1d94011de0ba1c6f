"""Read `[cylinders.NAME.valve]`: one area or four, overlaps, ISO 6358 in place of any area, one command or two."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from exo_sim.errors import RigError
from exo_sim.physics.compressed_air import FREE_AIR_DENSITY, FREE_AIR_TEMPERATURE
from exo_sim.physics.effects.valve_edges import EDGES
from exo_sim.physics.nozzle import critical_flow_factor
from exo_sim.rig.schema import VALVE_KINDS, Cylinder, EffectSetting, Recovery, Rig, Valve
from exo_sim.rig.table import Table

CONDUCTANCE = "m^3/(s Pa)"
#: A path that is a smaller share of the bore's square takes a third of an hour to fill a chamber as long as its bore: a unit was slipped.
LEAST_SHARE = 1e-7
_K, _R = 1.4, 287.05


def area_of(conductance: float) -> float:
    """Return the effective throat area [m^2] that passes the choked flow of a sonic conductance C of ISO 6358 [m^3/(s Pa)].

    C rho_0 p sqrt(T_0/T) = A gamma* sqrt(k/(R T)) p with the reference of ISO 8778 and air's k and R.

    >>> round(1e6 * area_of(1e-8), 3)
    5.02
    """
    return conductance * FREE_AIR_DENSITY * math.sqrt(FREE_AIR_TEMPERATURE * _R / _K) / critical_flow_factor(_K)


def read_valve(name: str, part: Table | None, bore: float) -> tuple[float, Valve, list[EffectSetting]]:
    """Return the area of a valve's largest path [m^2], what else it is, and the effects that say how its edges differ.

    Args:
        name: Of the cylinder.
        part: Its table, or None where there is no valve.
        bore: Of the cylinder [m]: no path is larger than its square.

    Raises:
        RigError: one line that names the key.
    """
    if part is None:
        return 0.0, Valve(), []
    kind = part.text("kind", "4-way", VALVE_KINDS)
    sizes: list[tuple[str, float, str]] = []
    whole = _size(part, "", bore, sizes)
    edges = [_size(part, f"_{edge}", bore, sizes) for edge in EDGES]
    if whole is None and None in edges:
        missing = EDGES[edges.index(None)]
        wanted = "area" if edges == [None] * 4 else f"area_{missing}"
        raise part.missing(wanted, 'give it like "5 mm^2", or C = "1 dm^3/(s bar)" of ISO 6358')
    areas = [whole if edge is None else edge for edge in edges]
    area = max(one for one in areas if one is not None)
    if area <= 0.0:
        raise part.fail(sizes[0][0], "leaves every path closed: give one of them an area")
    excess = {f"excess_{edge}": one / area - 1.0 for edge, one in zip(EDGES, areas) if one is not None and one != area}
    overlap = {
        f"overlap_{edge}": part.quantity(f"overlap_{edge}", "1", 0.0, at_least=-0.5, most=0.9)
        for edge in EDGES
        if part.has(f"overlap_{edge}")
    }
    ratio = _critical_ratio(part)
    part.done()
    effects = []
    if excess or any(overlap.values()):
        effects.append(EffectSetting("valve_edges", name, {**overlap, **excess}, of_valve=True))
    if ratio is not None:
        effects.append(EffectSetting("critical_ratio", name, {"ratio": ratio}, of_valve=True))
    return area, Valve(kind == "independent", tuple(sizes)), effects


def _size(part: Table, suffix: str, bore: float, sizes: list[tuple[str, float, str]]) -> float | None:
    """Return the area that `area` or `C` gives the paths of a suffix, or None where neither stands; `sizes` remembers what did."""
    area, conductance = f"area{suffix}", f"C{suffix}"
    if part.has(area) and part.has(conductance):
        raise part.fail(conductance, f"says the same as {area}: give one of them")
    if part.has(area):
        found = part.quantity(area, "m^2", **_above(suffix))
        sizes.append((area, found, "m^2"))
        key = area
    elif part.has(conductance):
        said = part.quantity(conductance, CONDUCTANCE, **_above(suffix))
        sizes.append((conductance, said, CONDUCTANCE))
        found, key = area_of(said), conductance
    else:
        return None
    if found > bore**2:
        raise part.fail(key, f"is larger than the piston of a {bore:g} m bore; is the unit right?")
    if 0.0 < found < LEAST_SHARE * bore**2:
        raise part.fail(key, f"is a hole of {1e6 * math.sqrt(found):.2g} um, which fills a {bore:g} m bore in hours; is the unit right?")
    return found


def _above(suffix: str) -> dict[str, float]:
    return {"at_least": 0.0} if suffix else {"above": 0.0}


def _critical_ratio(part: Table) -> float | None:
    """Return b of ISO 6358, or None where the paths are nozzles.

    Raises:
        RigError: edges with ratios of their own that differ.
    """
    keys = [key for key in ("b", *(f"b_{edge}" for edge in EDGES)) if part.has(key)]
    found = {key: part.quantity(key, "1", at_least=0.02, most=0.6) for key in keys}
    if len(set(found.values())) > 1:
        raise RigError(
            f"{part.path}: {part.key}: {' and '.join(f'{key} = {value:g}' for key, value in found.items())} differ; the paths of one "
            "valve share one critical ratio: give one b"
        )
    return next(iter(found.values()), None)


def with_valves(effects: tuple[EffectSetting, ...], of_valves: Sequence[EffectSetting]) -> tuple[EffectSetting, ...]:
    """Return the effects with those of the valves; numbers of an `[effects]` table of the same name and place go before a valve's."""
    of_valve = {(effect.name, effect.where): effect for effect in of_valves}
    merged = []
    for effect in effects:
        own = of_valve.pop((effect.name, effect.where), None)
        merged.append(effect if own is None else replace(effect, parameters={**own.parameters, **effect.parameters}))
    return (*merged, *of_valve.values())


def check_edges(path: Path, cylinders: Mapping[str, Cylinder]) -> None:
    """Refuse a recovery tank beside valves that move both chambers with one command.

    Raises:
        RigError: there is one; it names the first.
    """
    for name, cylinder in cylinders.items():
        if cylinder.valve_area > 0.0 and not cylinder.valve.independent:
            raise RigError(
                f'{path}: cylinders.{name}.valve.kind = "4-way": a recovery tank is for chambers with edges of their own; '
                'give every valve kind = "independent" (or --valves independent), or leave the tank out'
            )


def with_tank(rig: Rig, volume: float) -> Rig:
    """Return a rig with a recovery tank of a volume [m^3], at its own pressure or three times the atmosphere's; 0 for none.

    Raises:
        RigError: a valve moves both chambers with one command.
    """
    if volume <= 0.0:
        return replace(rig, recovery=None)
    check_edges(rig.path, rig.cylinders)
    return replace(rig, recovery=Recovery(volume, rig.recovery.pressure if rig.recovery is not None else 3.0 * rig.environment.pressure))


def with_edges(rig: Rig) -> Rig:
    """Return a rig whose double-acting cylinders have valves with a command of their own for each chamber."""
    changed = {
        name: c if c.single_acting or c.valve_area <= 0.0 else replace(c, valve=replace(c.valve, independent=True))
        for name, c in rig.cylinders.items()
    }
    return replace(rig, cylinders=changed)
