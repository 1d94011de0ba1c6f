"""A rig's text with other values in it: comments and order stay, what cannot be is one line."""

from __future__ import annotations

import tomllib
from typing import Any

import pytest

from exo_sim.errors import RigError
from exo_sim.rig.changing import with_values

TEXT = '# my rig\nname = "bench"  # its name\n[supply]\npressure = "7 bar"\n'


def test_values_are_put_in_and_everything_else_stays() -> None:
    changed = with_values(TEXT, {"supply.pressure": "8 bar", ("effects", "valve_lag", "piston", "delay"): "5 ms"})
    assert changed.startswith('# my rig\nname = "bench"  # its name\n')
    held = tomllib.loads(changed)
    assert held["supply"] == {"pressure": "8 bar"} and held["effects"]["valve_lag"]["piston"] == {"delay": "5 ms"}
    assert with_values(TEXT, {}) == TEXT


def test_a_key_is_taken_away() -> None:
    assert tomllib.loads(with_values(TEXT, {"supply.pressure": None})) == {"name": "bench", "supply": {}}


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [("supply.presure", None, "no such key"), ("tank.volume", None, "no such key"), ("name.first", "x", "holds a value"),
     ("supply.pressure", object(), "write text with a unit")],
)  # fmt: skip
def test_what_cannot_be_is_one_line(key: str, value: Any, says: str) -> None:
    with pytest.raises(RigError, match=says):
        with_values(TEXT, {key: value})
