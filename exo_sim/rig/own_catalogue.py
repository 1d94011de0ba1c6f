"""Read a catalogue: `[[cylinder]]` and `[[valve]]` tables in a TOML file, one's own or one of the makers' that come along.

What comes along says of each entry where its figures are from (`source`), and which of them are estimates (`estimated`).
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path

from exo_sim.errors import RigError, nearest
from exo_sim.inputs import refusing, text_of, toml
from exo_sim.rig.catalogue import CATALOGUE, RATED_PRESSURE, CatalogueCylinder
from exo_sim.rig.schema import VALVE_KINDS
from exo_sim.rig.table import Table
from exo_sim.rig.valve import CONDUCTANCE, area_of

_ATMOSPHERE = 101325.0
_INCLUDED = Path(__file__).resolve().parents[1] / "assets" / "catalogues"
#: Figures of an entry that its maker may leave open, so that they are estimates.
_CYLINDER_FIGURES = ("rod", "strokes", "pivot_length", "mass_0", "mass_per_metre", "rating", "coldest")
_VALVE_FIGURES = ("C", "b", "area", "lag", "mass")


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
        source: Where its figures come from.
        estimated: Those of its figures that are estimates, by the words of a catalogue file.
    """

    name: str
    area: float
    ratio: float = 0.0
    kind: str = "4-way"
    lag: float = 0.0
    mass: float = 0.0
    source: str = ""
    estimated: tuple[str, ...] = ()


@dataclass(frozen=True)
class Catalogue:
    """What may be chosen from: cylinders by rising bore, and valves by rising area; without valves any area may be had."""

    cylinders: tuple[CatalogueCylinder, ...] = CATALOGUE
    valves: tuple[CatalogueValve, ...] = ()


def included_catalogues() -> dict[str, Path]:
    """Return the makers' catalogues that come with the package, by name."""
    return {path.stem: path for path in sorted(_INCLUDED.glob("*.toml"))}


def find_catalogue(name: str | os.PathLike[str]) -> Path:
    """Return the path of a catalogue: a file, or the name of one that comes along where there is no such file.

    Raises:
        RigError: a plain name that is neither.
    """
    path, included = Path(name), included_catalogues()
    if path.exists() or path.suffix or path.name != str(name):
        return path
    if str(name) not in included:
        raise RigError(f'there is no file "{name}", and no catalogue of that name comes along{nearest(str(name), included)}')
    return included[str(name)]


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
    estimated = _estimated(part, _CYLINDER_FIGURES)
    found = CatalogueCylinder(
        standard=" ".join(word for word in (maker, part.text("series", "")) if word) or "own",
        bore=bore,
        rod=rod,
        strokes=_strokes(part),
        pivot_length=part.quantity("pivot_length", "m", default=_pivot_length(bore), above=0.0, most=10.0),
        mass_without_stroke=part.quantity("mass_0", "kg", at_least=0.0, most=1e4),
        mass_per_length=part.quantity("mass_per_metre", "kg/m", at_least=0.0, most=1e4),
        rating=part.quantity("rating", "Pa", default=RATED_PRESSURE + _ATMOSPHERE, above=_ATMOSPHERE, most=1e9),
        maker=maker,
        coldest=part.quantity("coldest", "K", above=100.0, most=400.0) if part.has("coldest") else None,
        source=part.text("source", ""),
        estimated=estimated if part.has("pivot_length") else tuple(dict.fromkeys((*estimated, "pivot_length"))),
    )
    part.done()
    return found


def _estimated(part: Table, known: tuple[str, ...]) -> tuple[str, ...]:
    if not part.has("estimated"):
        return ()
    held = part.values["estimated"]
    if not isinstance(held, list) or not all(isinstance(word, str) for word in held):
        raise part.fail("estimated", 'must be a list of keys: give it like estimated = ["mass_0"]')
    for word in held:
        if word not in known:
            raise part.fail("estimated", f'"{word}" is no key of this entry{nearest(word, known)}')
    return tuple(str(word) for word in held)


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
        name=" ".join(word for word in (part.text("maker", ""), part.text("name", "") or f"valve {number}") if word),
        area=area,
        ratio=part.quantity("b", "1", default=0.0, at_least=0.02, most=0.6),
        kind=part.text("kind", "4-way", VALVE_KINDS),
        lag=part.quantity("lag", "s", default=0.0, at_least=0.0, most=1.0),
        mass=part.quantity("mass", "kg", default=0.0, at_least=0.0, most=100.0),
        source=part.text("source", ""),
        estimated=_estimated(part, _VALVE_FIGURES),
    )
    part.done()
    return found
