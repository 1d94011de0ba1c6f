"""Numbers for people: SI values in the unit and with the digits in which they are read most easily."""

from __future__ import annotations

import math
from collections.abc import Sequence

#: SI unit to (shown unit, its size in SI, smallest value it is used from); the first that fits is taken.
_SCALES: dict[str, tuple[tuple[str, float, float], ...]] = {
    "Pa": (("bar", 1e5, 1e5), ("kPa", 1e3, 1e3), ("Pa", 1.0, 0.0)),
    "m": (("m", 1.0, 1.0), ("mm", 1e-3, 1e-3), ("µm", 1e-6, 0.0)),
    "m/s": (("m/s", 1.0, 0.1), ("mm/s", 1e-3, 0.0)),
    "rad": (("rad", 1.0, 1.0), ("mrad", 1e-3, 0.0)),
    "rad/s": (("rad/s", 1.0, 0.1), ("mrad/s", 1e-3, 0.0)),
    "s": (("s", 1.0, 1.0), ("ms", 1e-3, 0.0)),
    "m^2": (("cm²", 1e-4, 1e-3), ("mm²", 1e-6, 0.0)),
    "m^3": (("l", 1e-3, 1e-3), ("cm³", 1e-6, 0.0)),
    "kg/s": (("kg/s", 1.0, 1.0), ("g/s", 1e-3, 1e-3), ("mg/s", 1e-6, 0.0)),
    "N": (("kN", 1e3, 1e4), ("N", 1.0, 0.01), ("mN", 1e-3, 0.0)),
    "N*m": (("N m", 1.0, 0.01), ("mN m", 1e-3, 0.0)),
}
_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def shown_in(unit: str, largest: float) -> tuple[str, float]:
    """Return the unit in which numbers up to `largest` (SI) are shown, and its size in SI."""
    for name, size, least in _SCALES.get(unit, ()):
        if abs(largest) >= least:
            return name, size
    return spelt(unit), 1.0


def spelt(unit: str) -> str:
    """Return a unit as it is set in print: "N m", "m²"; nothing for a bare number."""
    if unit in ("", "1"):
        return ""
    out, power = "", False
    for character in unit.replace("*", " "):
        if character == "^":
            power = True
        elif power and (character.isdigit() or character == "-"):
            out += character.translate(_SUPERSCRIPT)
        else:
            out, power = out + character, False
    return out


def digits(value: float, significant: int = 3) -> str:
    """Return a number with a few significant digits; very large and very small ones with a power of ten."""
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    mantissa, _, power = f"{value:.{significant - 1}e}".partition("e")
    exponent = int(power)
    if exponent < -4 or exponent >= 6:
        return f"{mantissa} × 10{str(exponent).translate(_SUPERSCRIPT)}"
    decimals = max(significant - 1 - exponent, 0)
    return f"{round(value, significant - 1 - exponent):.{decimals}f}"


def amount(value: float, unit: str, significant: int = 3) -> str:
    """Return a value in SI as it is read most easily: 9423 Pa as "9.42 kPa"."""
    if not math.isfinite(value):
        return "–"
    name, size = shown_in(unit, value)
    return f"{digits(value / size, significant)} {name}".rstrip()


def interval(value: float, low: float, high: float, unit: str) -> tuple[str, str]:
    """Return value and interval as (text, text) in one unit and with the digits that the interval's width allows."""
    name, size = shown_in(unit, value if value else max(abs(low), abs(high)))
    scaled = [value / size, low / size, high / size]
    width = abs(scaled[2] - scaled[1])
    top = max((abs(v) for v in scaled if math.isfinite(v)), default=0.0)
    if top == 0.0 or not all(map(math.isfinite, scaled)):
        shown = [digits(v) for v in scaled]
    elif top >= 1e6 or top < 1e-4:
        shown = [digits(v, _significant(v, width)) for v in scaled]
    else:
        decimals = min(max(1 - math.floor(math.log10(width)), 0), 9) if width > 0.0 else 6
        shown = [f"{v:.{decimals}f}" for v in scaled]
    return f"{shown[0]} {name}".rstrip(), f"{shown[1]} to {shown[2]} {name}".rstrip()


def _significant(value: float, width: float) -> int:
    if value == 0.0 or width <= 0.0:
        return 3
    return min(max(math.floor(math.log10(abs(value))) - math.floor(math.log10(width)) + 2, 2), 6)


def share(value: float) -> str:
    """Return a share as percent; "under 1 %" and "over 99 %" where whole percents would say nothing or everything."""
    if not math.isfinite(value):
        return "–"
    if 0.0 < value < 0.01:
        return "under 1 %"
    if 0.99 < value < 1.0:
        return f"{min(100 * value, 99.9):.1f} %"
    return f"{100 * value:.0f} %"


def _moment(time: float) -> str:
    return f"{time:.2f}".rstrip("0").rstrip(".")


def spans(values: Sequence[tuple[float, float]], most: int = 4) -> str:
    """Return spans of time as text: "3.10–4.25 s, 7.00–7.50 s and 3 more"."""
    shown = [f"{_moment(start)}–{_moment(stop)} s" for start, stop in values[:most]]
    more = len(values) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more > 0 else "")
