"""One table of a rig file: every complaint names file, key, value and what to do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from exo_sim.errors import RigError
from exo_sim.rig.table import Table


def table(**values: Any) -> Table:
    return Table(Path("rig.toml"), "supply", values)


def test_values_come_in_si_and_defaults_where_they_are_absent() -> None:
    one = table(pressure="7 bar", kind="tank", ends=["1 mm", "2 cm"], inner={"a": 1})
    assert one.quantity("pressure", "Pa") == pytest.approx(7e5) and one.quantity("volume", "m^3", 1e-3) == 1e-3
    assert one.text("kind", choices=("tank", "regulator")) == "tank" and one.text("other", "none") == "none"
    assert one.quantities("ends", "m", ("low", "high")) == pytest.approx((1e-3, 2e-2))
    inner = one.table("inner")
    assert inner is not None and inner.name("a") == "supply.inner.a" and one.table("absent", required=False) is None
    one.done()


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda t: t.quantity("presure", "Pa"), r'supply.presure is missing; is it spelt "pressure"\? Give it like "7 bar"$'),
        (lambda t: t.quantity("bore", "m"), 'supply.bore is missing: give it like "32 mm"$'),
        (lambda t: t.text("model"), "supply.model is missing: name the MJCF file"),
        (lambda t: t.text("actuator"), "supply.actuator is missing: name the MJCF motor"),
        (lambda t: t.text("kinds"), r'supply.kinds is missing; is it spelt "kind"\?$'),
        (lambda t: t.quantity("lift", "m"), 'supply.lift is missing: give it like "50 mm"$'),
        (lambda t: t.quantity("drag", "N s/m"), 'supply.drag is missing: give it like "1 N s/m"$'),
        (lambda t: t.table("kinds"), r'the table \[supply.kinds\] is missing; is it spelt "kind"\?$'),
        (lambda t: t.quantity("pressure", "m"), "supply.pressure"),
        (lambda t: t.quantity("pressure", "Pa", above=1e6), "must be more than 1e\\+06 Pa"),
        (lambda t: t.quantity("pressure", "Pa", most=1e5), "at most 100000 Pa"),
        (lambda t: t.text("kind", choices=("tank",)), 'did you mean "tank"'),
        (lambda t: t.text("number"), "must be text in quotes"),
        (lambda t: t.quantities("pressure", "Pa", ("low", "high")), "must be a pair"),
        (lambda t: t.table("pressure"), "must be a table"),
        (lambda t: t.done(), "is not a key of a rig"),
    ],
)  # fmt: skip
def test_what_cannot_be_names_file_and_key(ask: Any, says: str) -> None:
    with pytest.raises(RigError, match=says) as caught:
        ask(table(pressure="7 bar", kind="tnak", number=3))
    assert str(caught.value).startswith("rig.toml: ") and "\n" not in str(caught.value)
