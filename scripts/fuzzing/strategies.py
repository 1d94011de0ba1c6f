"""Strategies that draw edits of files (`fuzzing.edits`), by the kind of the file."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from exo_sim.physics.declaration import Parameter, declared
from fuzzing import fragments

Edit = list[Any]

_TEXTS = st.one_of(st.sampled_from(fragments.BYTES), st.text(max_size=8), st.binary(max_size=8).map(lambda held: held.decode("latin-1")))
_NUMBERS, _UNITS = st.sampled_from(fragments.NUMBERS), st.sampled_from(fragments.UNITS)
_PLACES, _FEW = st.integers(0, 1 << 16), st.integers(0, 40)
_FLOATS = st.one_of(st.sampled_from([0.0, -1.0, 1e-3, 1e3, 101325.0, -1e5, 57.29577951308232, 25.4, 1e300, 1e-320]), st.floats(width=64))


def of_bytes(*names: str) -> SearchStrategy[Edit]:
    """Edits of any file."""
    name = st.sampled_from(names)
    return st.one_of(
        _edit("splice", name, _PLACES, _FEW, _TEXTS),
        _edit("repeat", name, _PLACES, _FEW, st.sampled_from([2, 3, 100, 100_000])),
        _edit("cut", name, _PLACES),
        _edit("kind", name, st.sampled_from(fragments.KINDS)),
    )


def of_toml(*names: str) -> SearchStrategy[Edit]:
    """Edits of keys, tables and (twice as often) values."""
    name = st.sampled_from(names)
    wild = st.builds(lambda number, unit: f'"{number} {unit}"', _NUMBERS, _UNITS)
    near = st.builds(lambda e, unit: f'"{10.0**e:.6g} {unit}"', st.floats(-12.0, 12.0), st.sampled_from(fragments.SOUND_UNITS))
    value = st.one_of(wild, near, st.sampled_from(fragments.TOML), _NUMBERS, _TEXTS.map(lambda text: f'"{text}"'))
    key = st.one_of(_TEXTS, st.sampled_from(fragments.KEYS))
    values = _edit("value", name, _FEW, value)
    return st.one_of(values, values, _edit("key", name, _FEW, key), _edit("table", name, _FEW, key))


def of_table(name: str) -> SearchStrategy[Edit]:
    """Edits of cells, headings, rows and whole columns: what a sensor, a clock or a spreadsheet does."""
    file, column, row = st.just(name), st.integers(0, 4), st.integers(0, 401)
    cell = st.one_of(_NUMBERS, _TEXTS, st.floats().map(str))
    heading = st.builds(lambda name, unit: f"{name} [{unit}]", st.sampled_from(fragments.HEADINGS), _UNITS)
    laws = st.sampled_from(["scale", "offset", "constant", "hold", "alternate", "wrap", "nan"])
    columns = _edit("column", file, column, laws, _FLOATS)
    return st.one_of(
        columns,
        columns,
        _edit("cell", file, row, column, cell),
        _edit("cell", file, st.just(0), column, st.one_of(heading, cell)),
        _edit("rows", file, row, st.sampled_from([1, 5, 50, 400]), st.sampled_from(["drop", "twice", "backwards", "blank", "short"])),
    )


def of_model(name: str) -> SearchStrategy[Edit]:
    """Edits of an MJCF's attributes and elements."""
    attribute = _edit("attribute", st.just(name), _FEW, st.one_of(st.sampled_from(fragments.ATTRIBUTES), _TEXTS))
    return st.one_of(attribute, attribute, _edit("element", st.just(name), _FEW, st.sampled_from(fragments.ELEMENTS)))


def of_controller(name: str) -> SearchStrategy[Edit]:
    """Edits that put other statements in a controller's methods, or other values in what it returns."""
    line = st.sampled_from(fragments.STATEMENTS).map(lambda text: "        " + text)
    value = st.one_of(st.sampled_from(fragments.RETURNED), _NUMBERS).map(lambda text: f"        return {text}")
    return st.one_of(
        _edit("line", st.just(name), st.sampled_from([3, 5]), line),
        _edit("line", st.just(name), st.just(5), value),
        _edit(
            "line",
            st.just(name),
            st.just(1),
            st.one_of(_NUMBERS, st.sampled_from(["None", "'fast'"])).map(lambda text: f"    period = {text}"),
        ),
    )


def of_json(*names: str) -> SearchStrategy[Edit]:
    """Edits that put anything in a value's place."""
    value = st.recursive(
        st.one_of(st.none(), st.booleans(), st.integers(-(10**30), 10**30), st.floats(), st.text(max_size=6), st.just("x" * 5000)),
        lambda held: st.one_of(st.lists(held, max_size=3), st.dictionaries(st.text(max_size=4), held, max_size=3)),
        max_leaves=5,
    )
    return _edit("leaf", st.sampled_from(names), st.integers(0, 60), value)


def some(*edits: SearchStrategy[Edit]) -> SearchStrategy[tuple[Edit, ...]]:
    """One to three of them."""
    return st.lists(st.one_of(*edits), min_size=1, max_size=3).map(tuple)


#: Values of assets/bench.toml in their order: the text of a word, or a typical number, decades about it and the unit.
_VALUES: list[str | tuple[float, float, str]] = [
    *('"bench"', '"bench.xml"', (1e5, 0.5, "Pa"), (293.0, 0.1, "K"), (287.0, 0.8, "J/(kg K)"), (1.4, 0.14, ""), (8e5, 1.5, "Pa")),
    *((293.0, 0.1, "K"), '"piston"', (32.0, 0.9, "mm"), (8.0, 1.0, "mm"), '"160 mm"', '"0 m"', (12.0, 3.0, "cm^3"), (12.0, 3.0, "cm^3")),
    *('"double"', (5.0, 2.0, "mm^2")),
]
_SHARES = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0.0, 1.0))


def of_sizes(name: str) -> SearchStrategy[Edit]:
    """Edits that make the bench larger or smaller, up to what a rig file may say."""

    def sized(place: int, share: float) -> Edit:
        value = _VALUES[place]
        if isinstance(value, tuple):
            number = f"{value[0] * 10.0 ** ((2.0 * share - 1.0) * value[1]):.9g}"
            value = f'"{number} {value[2]}"' if value[2] else number
        return ["value", name, place, value]

    return st.builds(sized, st.integers(0, len(_VALUES) - 1), _SHARES)


@st.composite
def effects(draw: st.DrawFn) -> str:
    """An effect as a rig file has it, every number within its bounds, often at them."""
    places = {"cylinder": "piston", "joint": "slide", "supply": "supply", "exhaust": "exhaust"}
    effect = draw(st.sampled_from([effect for effect in declared().values() if effect.places != ("column",)]))
    where = places[draw(st.sampled_from([place for place in effect.places if place in places]))]
    lines = [f"\n[effects.{effect.name}.{where}]"]
    for one in effect.parameters:
        if not one.required and draw(st.booleans()):
            continue
        if one.choices:
            texts = [draw(st.sampled_from(one.choices))]
        else:
            shares = sorted(draw(st.lists(_SHARES, min_size=2, max_size=one.most))) if one.most else [draw(_SHARES)]
            texts = [f"{_between(one, share)!r} {one.unit_at(False)}" for share in shares]
        quoted = ", ".join(f'"{text}"' for text in texts)
        lines.append(f"{one.name} = {f'[{quoted}]' if one.most else quoted}")
    return "\n".join(lines) + "\n"


def _between(one: Parameter, share: float) -> float:
    """Return a number between a parameter's bounds, by decades where both are above 0."""
    if share in (0.0, 1.0):
        return one.high if share else one.low
    if one.low > 0.0:
        return min(max(math.exp(math.log(one.low) + share * (math.log(one.high) - math.log(one.low))), one.low), one.high)
    return one.low + share * (one.high - one.low)


def _edit(kind: str, *parts: SearchStrategy[Any]) -> SearchStrategy[Edit]:
    return st.tuples(*parts).map(lambda held: [kind, *held])
