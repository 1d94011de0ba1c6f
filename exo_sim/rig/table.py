"""One table of a rig file, read key by key, so that every complaint names file, key, value and what to do."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

from exo_sim import units
from exo_sim.errors import RigError, UnitError, near, nearest

#: What a key, and any quantity of a unit, may be like.
_BY_KEY = {
    "bore": "32 mm", "rod": "12 mm", "stroke": "160 mm", "pressure": "7 bar", "volume": "2 l", "mass": "2 kg", "mass_0": "0.9 kg",
    "mass_per_metre": "4 kg/m",
}  # fmt: skip
_BY_UNIT = {
    "m": "50 mm", "m^2": "3 mm^2", "m^3": "10 cm^3", "Pa": "7 bar", "K": "293.15 K", "rad": "10 deg", "s": "10 ms",
    "m^3/(s Pa)": "1 dm^3/(s bar)", "1": "0.3",
}  # fmt: skip

#: ... and texts.
_TEXTS = {"model": 'name the MJCF file, like "machine.xml"', "actuator": "name the MJCF motor that takes the rod's force, in quotes"}


class Table:
    """Keys of one table; `done` refuses what nobody asked for.

    Args:
        path: The file, for messages.
        key: The table's dotted name, "" for the whole file.
        values: What the file holds.
        of: What it is a file of, for messages.
    """

    def __init__(self, path: Path, key: str, values: Any, of: str = "a rig"):
        self.path, self.key, self.of = path, key, of
        if isinstance(values, list) and values and all(isinstance(each, Mapping) for each in values):
            raise RigError(f"{path}: [[{key}]] is a list of tables: write [{key}], once, above its keys")
        if not isinstance(values, Mapping):
            raise RigError(f"{path}: {key} = {values!r} must be a table: write [{key}] above its keys")
        self.values = values
        self._asked: set[str] = set()

    def name(self, key: str) -> str:
        """Return the dotted name of a key."""
        return f"{self.key}.{key}" if self.key else key

    def fail(self, key: str, what: str) -> RigError:
        """Return an error about one key, naming its value where it has one."""
        value = f" = {self.values[key]!r}".replace("'", '"') if key in self.values else ""
        return RigError(f"{self.path}: {self.name(key)}{value}: {what}")

    def missing(self, key: str, what: str) -> RigError:
        """Return an error about a key that is not there."""
        unasked = [name for name in self.values if name not in self._asked]
        return RigError(f"{self.path}: {self.name(key)} is missing{_near(key, unasked, what)}")

    def has(self, key: str) -> bool:
        """Return whether the key is there."""
        self._asked.add(key)
        return key in self.values

    def table(self, key: str, required: bool = True) -> Table | None:
        """Return a table inside this one, or None where it is not required and absent."""
        if not self.has(key):
            if required:
                raise RigError(f"{self.path}: the table [{self.name(key)}] is missing{_near(key, self.values)}")
            return None
        return Table(self.path, self.name(key), self.values[key], self.of)

    def text(self, key: str, default: str | None = None, choices: Iterable[str] = ()) -> str:
        """Return a string, one of `choices` where there are any."""
        if not self.has(key):
            if default is None:
                raise self.missing(key, _TEXTS.get(key, ""))
            return default
        value = self.values[key]
        if not isinstance(value, str):
            raise self.fail(key, "must be text in quotes")
        known = tuple(choices)
        if known and value not in known:
            raise self.fail(key, f"is not known{nearest(value, known)}")
        return str(value)

    def quantity(
        self,
        key: str,
        si_unit: str,
        default: float | None = None,
        above: float | None = None,
        at_least: float | None = None,
        most: float | None = None,
    ) -> float:
        """Return a quantity in SI, checked against its bounds."""
        if not self.has(key):
            if default is None:
                raise self.missing(key, f'give it like "{_example(key, si_unit)}"')
            return default
        try:
            value = units.parse(_plain(self.values[key]), si_unit)
        except UnitError as error:
            raise RigError(f"{self.path}: {self.name(key)}: {error}") from None
        if above is not None and not value > above:
            raise self.fail(key, f"must be more than {_amount(above, si_unit)}")
        if at_least is not None and not value >= at_least:
            raise self.fail(key, f"must not be less than {_amount(at_least, si_unit)}")
        if most is not None and not value <= most:
            raise self.fail(key, f"is more than any machine of this kind has: at most {_amount(most, si_unit)}")
        return value

    def quantities(self, key: str, si_unit: str, names: tuple[str, str]) -> tuple[float, float]:
        """Return a pair of quantities in SI, which `names` call for messages."""
        example = f'give it like {key} = ["1 {si_unit}", "2 {si_unit}"], {names[0]} and {names[1]}'
        if not self.has(key):
            raise self.missing(key, example)
        held = self.values[key]
        if not isinstance(held, list) or len(held) != 2:
            raise self.fail(key, f"must be a pair: {example}")
        try:
            first, second = (units.parse(_plain(value), si_unit) for value in held)
        except UnitError as error:
            raise RigError(f"{self.path}: {self.name(key)}: {error}") from None
        return first, second

    def done(self) -> None:
        """Refuse keys that nobody asked for."""
        self.only(self._asked)

    def only(self, known: Collection[str]) -> None:
        """Refuse all other keys than these."""
        for key in self.values:
            if key not in known:
                raise RigError(f"{self.path}: {self.name(key)} is not a key of {self.of}{nearest(key, known)}")


def _amount(value: float, si_unit: str) -> str:
    return f"{value:g}" if si_unit == "1" else f"{value:g} {si_unit}"


def _plain(value: Any) -> Any:
    return value.unwrap() if hasattr(value, "unwrap") else value


def _near(key: str, present: Iterable[str], what: str = "") -> str:
    """Return the question whether a missing key is misspelt, if one is like it, and what to do."""
    if found := near(key, present):
        spelt = " or ".join(f'"{name}"' for name in found)
        return f"; is it spelt {spelt}?{f' {what[0].upper()}{what[1:]}' if what else ''}"
    return f": {what}" if what else ""


def _example(key: str, si_unit: str) -> str:
    return _BY_KEY.get(key, _BY_UNIT.get(si_unit, f"1 {si_unit}"))
