"""Quantities with units, at the edges only: text in, SI out. Inside the program everything is SI and radian."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import TYPE_CHECKING

from exo_sim.errors import UnitError, one_line
from exo_sim.unit_text import powers

if TYPE_CHECKING:
    import pint

#: Longest text of a quantity and of a unit, in characters; longer ones are refused unread.
LONGEST, LONGEST_UNIT = 120, 60
#: Magnitudes in SI that no machine comes near: squares and cubes of what lies between are numbers, too.
SMALLEST, LARGEST = 1e-50, 1e30

#: Units that rigs and recordings are written in, as a factor on powers of metre, kilogram, second, kelvin and radian: to convert them the
#: library that knows all others, which takes half a second to begin, is not loaded.
_COMMON: dict[str, tuple[float, tuple[int, ...]]] = {
    "m": (1.0, (1, 0, 0, 0, 0)), "cm": (1e-2, (1, 0, 0, 0, 0)), "mm": (1e-3, (1, 0, 0, 0, 0)),
    "kg": (1.0, (0, 1, 0, 0, 0)), "g": (1e-3, (0, 1, 0, 0, 0)), "s": (1.0, (0, 0, 1, 0, 0)), "ms": (1e-3, (0, 0, 1, 0, 0)),
    "K": (1.0, (0, 0, 0, 1, 0)), "rad": (1.0, (0, 0, 0, 0, 1)), "N": (1.0, (1, 1, -2, 0, 0)), "kN": (1e3, (1, 1, -2, 0, 0)),
    "Pa": (1.0, (-1, 1, -2, 0, 0)), "kPa": (1e3, (-1, 1, -2, 0, 0)), "bar": (1e5, (-1, 1, -2, 0, 0)),
    "J": (1.0, (2, 1, -2, 0, 0)), "W": (1.0, (2, 1, -3, 0, 0)),
}  # fmt: skip
#: By SI unit, the unit that a number without one is likely in, where it is between these.
_LIKELY = {
    "m": ("mm", 3.0, math.inf), "Pa": ("bar", 0.01, 1e3), "m^2": ("mm^2", 1e-2, math.inf), "m^3": ("l", 0.05, math.inf),
    "K": ("degC", -math.inf, 150.0), "rad": ("deg", 3.2, math.inf),
}  # fmt: skip
#: Names of pressures that may say whether they count from the atmosphere or from nothing.
_PRESSURE = r"(?:[hkm]?pa|m?bar|psi|atm|torr)"
_GAUGE = re.compile(rf"\b{_PRESSURE}[\s_]*\(?\s*(?:g|ga|rel|relative|ü)(?!\w)|\bgau?ge\b", re.IGNORECASE)
_COUNTS_IN = re.compile(rf"\s*({_PRESSURE})", re.IGNORECASE)
_ABSOLUTE = re.compile(rf"\b({_PRESSURE})[\s_]*(?:a|abs|absolute|\(\s*(?:a|abs|absolute)\.?\s*\))\s*$", re.IGNORECASE)
#: Units that are often written in the wrong case, or by another sign, by what they are written as in lower case.
_MEANT = {
    **{unit.lower(): unit for unit in ("Pa", "hPa", "kPa", "MPa", "bar", "mbar", "psi", "atm", "N", "kN", "kg")},
    **{unit.lower(): unit for unit in ("m", "cm", "mm", "in", "s", "ms", "rad", "deg", "K", "degC", "degF")},
    "sek": "s", "c": "degC", "f": "degF", "nm": "N*m",
}  # fmt: skip
_QUANTITY = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
#: What TOML calls that which Python calls otherwise.
_KINDS: dict[type, str] = {dict: "table"}
_DECIMAL_COMMA = re.compile(r"^\s*([-+]?\d*),(\d.*?)\s*$")


def is_gauge(unit: str) -> bool:
    """Return True for a pressure unit counted from the atmosphere, like "psig" or "bar gauge"."""
    return _GAUGE.search(unit) is not None


def without_gauge(unit: str) -> str:
    """Return the unit that a gauge unit counts in: "psi" for "psig"; "bar" where none is recognised."""
    found = _COUNTS_IN.match(unit)
    return found[1] if found else "bar"


@cache
def _registry() -> pint.UnitRegistry:
    import pint

    return pint.UnitRegistry(cache_folder=None, autoconvert_offset_to_baseunit=True)


@cache
def scale_and_offset(unit: str, si_unit: str) -> tuple[float, float]:
    """Return `(scale, offset)` with `si = value * scale + offset` for one unit.

    Raises:
        UnitError: the unit is unknown, gauge, or of another kind than `si_unit`.
    """
    if len(unit) > LONGEST_UNIT:
        raise UnitError(f'unit "{unit[:20]}..." has {len(unit)} characters; write it like "{si_unit}"')
    if is_gauge(unit):
        raise UnitError(f'unit "{unit}" is gauge; pressures are absolute: add the atmosphere and write "Pa" or "bar"')
    given, unit = unit, _ABSOLUTE.sub(r"\1", unit)
    if unit in ("", "1") or si_unit == "1":
        if unit in ("", "1") and si_unit == "1":
            return 1.0, 0.0
        if unit == "%" and si_unit == "1":
            return 0.01, 0.0
        share = "; a number without unit, or with %, is wanted" if si_unit == "1" else ""
        raise UnitError(f'unit "{unit or "(none)"}" cannot be converted to "{si_unit}"{share}')
    common, wanted = _in_common_units(unit), _in_common_units(si_unit)
    if common is not None and wanted is not None and common[1] == wanted[1]:
        return float(f"{common[0] / wanted[0]:.15g}"), 0.0
    import pint

    registry = _registry()
    plain = " * ".join(name if power == 1 else f"{name} ** {power}" for name, power in powers(unit).items())
    try:
        zero = registry.Quantity(0.0, plain).to(si_unit).magnitude
        one = registry.Quantity(1.0, plain).to(si_unit).magnitude
    except pint.UndefinedUnitError:
        raise UnitError(f'unknown unit "{given}"; {_meant(given, si_unit)}') from None
    except pint.DimensionalityError:
        raise UnitError(f'unit "{given}" is not a unit of this kind; {_meant(given, si_unit)}') from None
    except Exception:
        raise UnitError(f'cannot read the unit "{given}"; write it like "{si_unit}"') from None
    # exact decimal scales (1 cm^3 is 1e-06, not 1.0000000000000002e-06)
    return float(f"{one - zero:.15g}"), float(f"{zero:.15g}")


def _meant(unit: str, si_unit: str) -> str:
    """Return what to write in place of a unit: that of the same letters and of the kind wanted, if there is one."""
    likely = _MEANT.get(unit.lower(), unit)
    if likely != unit and _fits(likely, si_unit):
        return f'did you mean "{likely}"?'
    return f'write it like "{si_unit}"'


def _fits(unit: str, si_unit: str) -> bool:
    try:
        scale_and_offset(unit, si_unit)
    except UnitError:
        return False
    return True


def _in_common_units(unit: str) -> tuple[float, tuple[int, ...]] | None:
    """Return the factor of a unit made of common ones and its powers of metre, kilogram, second, kelvin and radian; None of others."""
    scale = 1.0
    dimension: tuple[int, ...] = (0, 0, 0, 0, 0)
    for name, power in powers(unit).items():
        if name not in _COMMON:
            return None
        factor, own = _COMMON[name]
        scale, dimension = scale * factor**power, tuple(a + power * b for a, b in zip(dimension, own, strict=True))
    return scale, dimension


def split(text: str, si_unit: str = "m") -> tuple[float, str]:
    """Return number and unit of a quantity's text; the unit wanted is named where it is none.

    Raises:
        UnitError: it does not begin with a number, or is too long to be a quantity.
    """
    if len(text) > LONGEST:
        raise UnitError(f'"{text[:20]}..." has {len(text)} characters; write {_example(si_unit)}')
    match = _QUANTITY.match(text)
    if match is None:
        raise UnitError(f'"{one_line(text)}" is not a quantity; write {_example(si_unit)}')
    if found := _DECIMAL_COMMA.match(text):
        raise UnitError(f'"{one_line(text)}" has a comma; decimals begin with a point, as in "{found[1]}.{found[2]}"')
    return float(match.group(1)), match.group(2)


def _example(si_unit: str) -> str:
    return 'a number, like "1"' if si_unit == "1" else f'a number and a unit, like "1 {si_unit}"'


def parse(text: object, si_unit: str) -> float:
    """Read `"32 mm"` as SI.

    Args:
        text: A number followed by a unit. A bare number is taken only where the SI unit is "1".
        si_unit: The SI unit wanted, e.g. "m^2" or "W/K".

    Raises:
        UnitError: no number, no unit, not finite, of a magnitude that no machine has, or a unit that cannot be `si_unit`.
    """
    if isinstance(text, bool) or not isinstance(text, int | float | str):
        shown = str(text).lower() if isinstance(text, bool) else f"a {_KINDS.get(type(text), type(text).__name__)}"
        raise UnitError(f'{shown} is not a quantity; write it like "1 {si_unit}"')
    if isinstance(text, str):
        value, unit = split(text, si_unit)
        if not unit and si_unit != "1":
            raise UnitError(f'"{text}" has no unit; write it with one, like "{text} {_likely(value, si_unit)}"')
    elif isinstance(text, int) and abs(text) > LARGEST:
        raise UnitError("an integer of so many digits is more than any machine has; is it right?")
    elif si_unit != "1":
        raise UnitError(f'{text} has no unit; write it in quotes with one, like "{text} {_likely(text, si_unit)}"')
    else:
        value, unit = float(text), "1"
    scale, offset = scale_and_offset(unit, si_unit)
    si = value * scale + offset
    if not math.isfinite(si):
        raise UnitError(f'"{text}" is not finite')
    if abs(si) > LARGEST or 0.0 < abs(si) < SMALLEST:
        raise UnitError(f'"{text}" is {"more" if abs(si) > 1.0 else "less"} than any machine has; is it right?')
    return float(f"{si:.15g}")


def _likely(number: float, si_unit: str) -> str:
    unit, low, high = _LIKELY.get(si_unit, (si_unit, 0.0, 0.0))
    return unit if low <= (number if unit == "degC" else abs(number)) <= high else si_unit


def is_of(text: object, si_unit: str) -> bool:
    """Return whether a text is a quantity of an SI unit's kind.

    >>> is_of("3 mm", "m"), is_of("3 deg", "m")
    (True, False)
    """
    try:
        parse(text, si_unit)
    except UnitError:
        return False
    return True


def write(value: float, si_unit: str) -> str | float:
    """Return the text that `parse` reads back to the same number; a pure number stays a number."""
    if si_unit == "1":
        return float(value)
    return f"{float(value)!r} {si_unit}"
