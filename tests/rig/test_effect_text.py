"""How numbers stand in a rig file: in units that are read easily, with as many digits as tell an interval's ends apart."""

from __future__ import annotations

import pytest

from exo_sim.physics.declaration import declared
from exo_sim.rig.effect_text import EffectEntry, amount, interval_text, readable, table_text, typed_unit
from exo_sim.rig.schema import EffectSetting


@pytest.mark.parametrize(
    ("value", "si", "unit", "scale"),
    [(0.02, "m", "mm", 1e-3), (2.0, "m", "m", 1.0), (-3e-6, "m^2", "mm^2", 1e-6), (0.0, "s", "s", 1.0), (5e3, "Pa", "Pa", 1.0)],
)
def test_small_numbers_get_a_small_unit(value: float, si: str, unit: str, scale: float) -> None:
    assert readable(value, si) == (unit, scale)


def test_an_amount_is_text_only_where_it_has_a_unit() -> None:
    assert amount(0.0123456789, "mm", 1e-3) == "12.34568 mm"
    assert amount(0.25, "1", 1.0) == amount(0.25, "", 1.0) == 0.25


def test_an_interval_has_as_many_digits_as_tell_its_ends_apart() -> None:
    assert interval_text((0.001, 0.002), "mm", 1e-3) == "95 %: 1 to 2 mm"
    assert interval_text((1.00001, 1.00002), "1", 1.0) == "95 %: 1.00001 to 1.00002"
    assert interval_text((3.0, 3.0), "N", 1.0) == "95 %: 3 to 3 N"


def test_the_owners_unit_is_kept_unless_it_has_an_offset() -> None:
    typed = typed_unit("30 mm", "m")
    assert typed is not None and typed[0] == "mm" and typed[1] == pytest.approx(1e-3)
    assert typed_unit("20 degC", "K") is None


def test_a_table_says_what_it_is_and_how_sure_its_numbers_are() -> None:
    setting = EffectSetting("coulomb_friction", "piston", {"force": 12.5})
    entry = EffectEntry(setting, {"force": (11.0, 14.0)}, "dry\nfriction")
    text = table_text(declared()["coulomb_friction"], entry)
    assert text.splitlines() == ["# dry friction", "[effects.coulomb_friction.piston]", 'force = "12.5 N"  # 95 %: 11 to 14 N']
