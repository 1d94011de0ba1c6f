"""An effect's page, read from its declaration: what it is, its numbers, how a rig file switches it on."""

from __future__ import annotations

import math
import textwrap
from typing import Any

from exo_sim.physics.declaration import Effect, Parameter, declared
from exo_sim.plain_text import table
from exo_sim.rig.effect_text import EffectEntry, table_text
from exo_sim.rig.schema import EffectSetting

#: How each kind of place is named in the example.
PLACES = {
    "cylinder": "piston",
    "joint": "knee",
    "supply": "supply",
    "exhaust": "exhaust",
    "column": "piston.pressure_1",
}


def typical(parameter: Parameter) -> float:
    """Return a round number in the middle of what is met in practice."""
    low, high = parameter.typical
    if parameter.choices:
        return 0.0
    middle = math.sqrt(low * high) if low > 0.0 else 0.5 * (low + high) or 0.5 * high
    return float(f"{middle:.1g}")


def example(effect: Effect) -> str:
    """Return the lines that switch the effect on in a rig file."""
    single = {p.name: typical(p) for p in effect.parameters if not p.most and (p.required or not _others(effect, p))}
    curves = {p.name: (p.typical[0], typical(p), p.typical[1]) for p in effect.parameters if p.most}
    if effect.any_of:
        keep = effect.any_of[0]
        single = {name: value for name, value in single.items() if name in keep}
    where = PLACES[effect.places[0]]
    text = table_text(effect, EffectEntry(EffectSetting(effect.name, where, single, False, curves)))
    if effect.requires:
        text = example(declared()[effect.requires]) + "\n" + text
    return text


def _others(effect: Effect, parameter: Parameter) -> bool:
    return bool(effect.any_of) and all(parameter.name not in names for names in effect.any_of)


def places(effect: Effect) -> str:
    """Return where the effect may act, in words."""
    words = {
        "cylinder": "a cylinder", "joint": "a joint", "supply": "the supply", "exhaust": "the exhaust", "column": "a recorded column"
    }  # fmt: skip
    return " or ".join(words[place] for place in effect.places)


def unit(parameter: Parameter) -> str:
    """Return a parameter's unit, the turning one too where it differs."""
    if parameter.choices:
        return ""
    if parameter.unit_by is not None:
        return ", ".join(dict.fromkeys(units[0] for units in parameter.unit_by[1]))
    if parameter.unit == "column":
        return "the column's"
    return f"{parameter.unit} ({parameter.angular_unit})" if parameter.angular_unit else parameter.unit


def bounds(parameter: Parameter) -> tuple[str, str]:
    """Return the typical range and the bounds of a parameter as text."""
    if parameter.choices:
        return " or ".join(parameter.choices), ""
    ends = _range(parameter.low, parameter.high)
    return _range(*parameter.typical), f"2 to {parameter.most} numbers, {ends}" if parameter.most else ends


def _range(low: float, high: float) -> str:
    return f"{low:g} to {high:g}"


def rows(effect: Effect) -> list[list[str]]:
    """Return one row a parameter: name, unit, typical range, bounds, source; optional ones say so."""
    return [
        [p.name, unit(p), *bounds(p), p.source if p.required else f"{p.source} (optional)"] for p in effect.parameters
    ]


def facts(effect: Effect) -> list[tuple[str, str]]:
    """Return what else there is to say, as (heading, sentence)."""
    shows = ", ".join(effect.reveals) or "the column itself"
    found = [
        ("acts on", places(effect)),
        ("looks like", effect.signature),
        ("shows in", shows + (f"; needs {', '.join(effect.needs)}" if effect.needs else "")),
        ("mistaken for", ", ".join(effect.mistaken_for)),
        ("tell apart by", effect.experiment),
        ("meaning", effect.convention),
        ("valid where", effect.valid),
        ("only with", effect.requires),
        ("instead of", ", ".join(name for name, _ in effect.absorbs)),
    ]
    return [(heading, text) for heading, text in found if text]


def text(effect: Effect) -> str:
    """Return the page as plain text."""
    stated = [textwrap.fill(f"{heading:15}{sentence}", 110, subsequent_indent=" " * 15) for heading, sentence in facts(effect)]
    lines = [f"    {line}" if line else "" for line in example(effect).splitlines()]
    numbers = table(rows(effect), ["parameter", "unit", "typical", "bounds", "source"])
    return "\n\n".join(
        [f"{effect.name}: {effect.says}", effect.question, "\n".join(stated), numbers, "In a rig file:", "\n".join(lines)]
    )


def data(effect: Effect) -> dict[str, Any]:
    """Return the declaration as plain values."""
    return {
        "name": effect.name,
        "family": effect.family,
        "places": list(effect.places),
        "question": effect.question,
        "says": effect.says,
        "parameters": [
            {
                "name": p.name, "unit": unit(p) or None, "typical": list(p.typical), "low": p.low, "high": p.high,
                "choices": list(p.choices), "list_of_up_to": p.most or None, "required": p.required, "source": p.source,
            }
            for p in effect.parameters
        ],
        "shows_in": list(effect.reveals),
        "needs": list(effect.needs),
        "signature": effect.signature,
        "mistaken_for": list(effect.mistaken_for),
        "experiment": effect.experiment,
        "convention": effect.convention,
        "valid": effect.valid,
        "example": example(effect),
    }  # fmt: skip
