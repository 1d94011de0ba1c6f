"""Numbers that a designer has decided already: `--fix NAME=VALUE`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from exo_sim import units
from exo_sim.errors import ScenarioError, UnitError, nearest

#: What may be fixed: the supply, the pressure of a recovery tank, and of each kind of joint its bore, valve area, and how far the
#: cylinder's ends are from the axis.
UNITS = {"supply": "Pa", "tank": "Pa", "bore": "m", "valve": "m^2", "from": "m", "to": "m"}

_SHARED = ("supply", "tank")


def unit_of(name: str) -> str:
    """Return the SI unit of a number that may be fixed; that of a length where there is no such name."""
    return UNITS.get(name.rpartition(".")[2], "m")


def fixed_numbers(texts: Sequence[str]) -> dict[str, float]:
    """Return fixed numbers in SI by name from texts like `supply=7 bar` or `hip.bore=40 mm`.

    Raises:
        ScenarioError: no name, a name that cannot be fixed, a value without its unit, or one name twice.
    """
    out: dict[str, float] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name:
            raise ScenarioError(f'--fix {text}: write it like supply="7 bar" or hip.bore="40 mm"')
        kind, _, word = name.rpartition(".")
        if word not in UNITS or (word in _SHARED) != (not kind):
            known = [*_SHARED, *(f"{kind or 'hip'}.{each}" for each in UNITS if each not in _SHARED)]
            raise ScenarioError(f"--fix {name}: cannot be fixed{nearest(name, known)}; what can is {', '.join(known)}")
        try:
            number = units.parse(value.strip("\"'"), UNITS[word])
        except UnitError as error:
            raise ScenarioError(f"--fix {name}: {error}") from None
        if not number > 0.0:
            raise ScenarioError(f"--fix {name}: {value} must be more than 0")
        if name in out:
            raise ScenarioError(f"--fix {name}: given twice; give it once")
        out[name] = number
    return out


def given_numbers(fix: Mapping[str, object] | Sequence[str]) -> dict[str, float]:
    """Return fixed numbers in SI by name from texts like `supply=7 bar`, or from names to SI numbers or texts with a unit.

    Raises:
        ScenarioError: as `fixed_numbers`.
    """
    if not isinstance(fix, Mapping):
        return fixed_numbers(list(fix))
    texts = [f"{name}={value}" if isinstance(value, str) else f"{name}={value!r} {unit_of(name)}" for name, value in fix.items()]
    return fixed_numbers(texts)
