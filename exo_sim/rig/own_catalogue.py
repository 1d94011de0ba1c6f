"""Read a catalogue of one's own: `[[cylinder]]` and `[[valve]]` tables in a TOML file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from exo_sim.errors import RigError
from exo_sim.inputs import refusing, text_of, toml
from exo_sim.rig.catalogue import CATALOGUE, RATED_PRESSURE, CatalogueCylinder
from exo_sim.rig.schema import VALVE_KINDS
from exo_sim.rig.table import Table
from exo_sim.rig.valve import CONDUCTANCE, area_of

_ATMOSPHERE = 101325.0


@dataclass(frozen=True)
class CatalogueValve:
    """One valve that can be bought.

    Attributes:
        name: What to call it.
        area: Effective throat area of each path at full command [m^2].
        ratio: b of ISO 6358; 0 where none is given: a nozzle.
        kind: "4-way" or "independent".
        lag: Time constant [s], 0 where none is given.
        mass: Of what one cylinder needs of it [kg].
    """

    name: str
    area: float
    ratio: float = 0.0
    kind: str = "4-way"
    lag: float = 0.0
    mass: float = 0.0


@dataclass(frozen=True)
class Catalogue:
    """What may be chosen from: cylinders by rising bore, and valves by rising area; without valves any area may be had."""

    cylinders: tuple[CatalogueCylinder, ...] = CATALOGUE
    valves: tuple[CatalogueValve, ...] = ()


def read_catalogue(path: Path) -> Catalogue:
    """Read a catalogue; cylinders or valves that it leaves out are those that come along.

    Raises:
        RigError: one line that names the file, the entry, the key and what to do.
    """
    with refusing(lambda says: RigError(f"{path}: {says}"), "no such catalogue"):
        values = toml(text_of(path))
    whole = Table(path, "", values, "a catalogue")
    cylinders = [_cylinder(part) for part in _entries(whole, "cylinder")]
    valves = [_valve(part, i) for i, part in enumerate(_entries(whole, "valve"), 1)]
    whole.done()
    if not cylinders and not valves:
        raise RigError(f"{path}: it holds no [[cylinder]] and no [[valve]]: give it at least one")
    return Catalogue(
        tuple(sorted(cylinders, key=lambda one: (one.bore, one.rod))) or CATALOGUE, tuple(sorted(valves, key=lambda one: one.area))
    )


def _entries(whole: Table, key: str) -> list[Table]:
    if not whole.has(key):
        return []
    held = whole.values[key]
    if not isinstance(held, list):
        raise RigError(f"{whole.path}: {key} must be a list of tables: write [[{key}]] above each entry of the catalogue")
    return [Table(whole.path, f"{key}[{i}]", entry, "a catalogue") for i, entry in enumerate(held, 1)]


def _cylinder(part: Table) -> CatalogueCylinder:
    bore = part.quantity("bore", "m", above=1e-3, most=1.0)
    rod = part.quantity("rod", "m", above=0.0)
    if rod >= bore:
        raise part.fail("rod", f"must be thinner than the bore ({bore:g} m)")
    maker = part.text("maker", "")
    found = CatalogueCylinder(
        standard=maker or "own",
        bore=bore,
        rod=rod,
        strokes=_strokes(part),
        pivot_length=part.quantity("pivot_length", "m", default=_pivot_length(bore), above=0.0, most=10.0),
        mass_without_stroke=part.quantity("mass_0", "kg", at_least=0.0, most=1e4),
        mass_per_length=part.quantity("mass_per_metre", "kg/m", at_least=0.0, most=1e4),
        rating=part.quantity("rating", "Pa", default=RATED_PRESSURE + _ATMOSPHERE, above=_ATMOSPHERE, most=1e9),
        maker=maker,
    )
    part.done()
    return found


def _strokes(part: Table) -> tuple[float, ...]:
    example = 'give it like strokes = ["80 mm", "100 mm"]'
    if not part.has("strokes"):
        raise part.missing("strokes", example)
    held = part.values["strokes"]
    if not isinstance(held, list) or not held:
        raise part.fail("strokes", f"must be a list: {example}")
    each = Table(part.path, part.name("strokes"), {str(i): value for i, value in enumerate(held, 1)}, "a catalogue")
    return tuple(sorted(each.quantity(key, "m", above=0.0, most=100.0) for key in each.values))


def _pivot_length(bore: float) -> float:
    """Return our estimate for a bore, between those of the catalogue's, beyond them in proportion to the bore [m]."""
    small, large = CATALOGUE[0], CATALOGUE[-1]
    if not small.bore < bore < large.bore:
        end = small if bore <= small.bore else large
        return end.pivot_length * bore / end.bore
    low = next(one for one in reversed(CATALOGUE) if one.bore <= bore)
    high = next(one for one in CATALOGUE if one.bore >= bore)
    if low is high:
        return low.pivot_length
    share = math.log(bore / low.bore) / math.log(high.bore / low.bore)
    return low.pivot_length + share * (high.pivot_length - low.pivot_length)


def _valve(part: Table, number: int) -> CatalogueValve:
    if part.has("C") and part.has("area"):
        raise part.fail("C", "says the same as area: give one of them")
    if part.has("C"):
        area = area_of(part.quantity("C", CONDUCTANCE, above=0.0))
    elif part.has("area"):
        area = part.quantity("area", "m^2", above=0.0)
    else:
        raise part.missing("area", 'give it like "5 mm^2", or C = "1 dm^3/(s bar)" of ISO 6358')
    if area > 1e-2:
        raise part.fail("C" if part.has("C") else "area", "is larger than any valve's of this kind; is the unit right?")
    found = CatalogueValve(
        name=part.text("name", "") or " ".join(word for word in (part.text("maker", ""), f"valve {number}") if word),
        area=area,
        ratio=part.quantity("b", "1", default=0.0, at_least=0.02, most=0.6),
        kind=part.text("kind", "4-way", VALVE_KINDS),
        lag=part.quantity("lag", "s", default=0.0, at_least=0.0, most=1.0),
        mass=part.quantity("mass", "kg", default=0.0, at_least=0.0, most=100.0),
    )
    part.done()
    return found
