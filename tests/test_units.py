from __future__ import annotations

import math
import re
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim import unit_text, units
from exo_sim.errors import UnitError


@pytest.mark.parametrize(
    ("text", "si_unit", "value"),
    [
        ("32 mm", "m", 0.032),
        ("12 cm^3", "m^3", 1.2e-5),
        ("5 mm^2", "m^2", 5e-6),
        ("7 bar", "Pa", 7e5),
        ("17 psi", "Pa", 17 * 6894.757293168361),  # 1 psi = 6894.757293168361 Pa, NIST SP 811
        ("20 degC", "K", 293.15),
        ("180 deg", "rad", math.pi),
        ("287.05 J/(kg K)", "J/(kg K)", 287.05),
        ("0.8 W/K", "W/K", 0.8),
        ("-3e-2m", "m", -0.03),
        ("3 %", "1", 0.03),
        (1.4, "1", 1.4),
        ("20 °C", "K", 293.15),
        ("20 deg C", "K", 293.15),
        ("180 °", "rad", math.pi),
        ("12 cm3", "m^3", 1.2e-5),
        ("9.81 m/s2", "m/s^2", 9.81),
        ("3 Nm", "N*m", 3.0),
        ("3 N.m", "N*m", 3.0),
        ("3 N-m", "N*m", 3.0),
    ],
)
def test_text_is_read_as_si(text: object, si_unit: str, value: float) -> None:
    assert units.parse(text, si_unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "si_unit", "says"),
    [
        ("5 barg", "Pa", "gauge"),
        ("5 bar gauge", "Pa", "gauge"),
        ("7,5 bar", "Pa", 'decimals begin with a point, as in "7.5 bar"'),
        ("20 C", "K", 'did you mean "degC"'),
        ("-90", "rad", 'like "-90 deg"'),
        ({}, "m", "a table is not a quantity"),
        ("60 psig", "Pa", "gauge"),
        ("32", "m", "no unit"),
        (32, "m", "no unit"),
        ("32 furlongish", "m", "unknown unit"),
        ("32 kg", "m", "not a unit of this kind"),
        ("wide", "m", "not a quantity"),
        (True, "m", "not a quantity"),
        ("1e999 m", "m", "not finite"),
        ("3 kg", "1", "cannot be converted"),
        ("1e300 m", "m", "more than any machine has"),
        ("-1e31 m", "m", "more than any machine has"),
        ("1e-300 m", "m", "less than any machine has"),
        (10**400, "1", "an integer of so many digits"),
        (["1 m"], "m", "a list is not a quantity"),
        (None, "m", "a NoneType is not a quantity"),
        ("1" * 5000 + " m", "m", "5002 characters"),
        ("1 " + "m" * 100, "m", "unit .* has 100 characters"),
        ("\n" * 50 + "x", "m", "not a quantity"),
        ("32 10**10**10", "m", "cannot read the unit"),
        ("32 m**10**10", "m", "cannot read the unit"),
        ("32 (m**9)**9", "m", "a power of more than 9"),
        ("32 m**999999999", "m", "cannot read the unit"),
        ("32 m + m", "m", "cannot read the unit"),
        ("32 2 m", "m", "cannot read the unit"),
        ("32 __import__('os')", "m", "cannot read the unit"),
        ("32 ((((m", "m", "a bracket is not closed"),
        ("32 m)", "m", "a bracket is closed that was not opened"),
        ("32 m/", "m", "a name is missing"),
    ],
)
def test_what_cannot_be_read_is_one_line_that_says_why(text: object, si_unit: str, says: str) -> None:
    with pytest.raises(UnitError, match=says) as caught:
        units.parse(text, si_unit)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("unit", ["psig", "psi g", "psi(g)", "bar (g)", "barü", "bar rel", "kPa gage", "MPa_g"])
def test_a_gauge_unit_says_that_it_is_gauge_however_it_is_written(unit: str) -> None:
    with pytest.raises(UnitError, match="is gauge"):
        units.parse(f"5 {unit}", "Pa")


@pytest.mark.parametrize(
    ("unit", "same"), [("psia", "psi"), ("bara", "bar"), ("bar(a)", "bar"), ("bar abs", "bar"), ("kPa (abs.)", "kPa")]
)
def test_a_unit_that_says_absolute_is_what_is_wanted(unit: str, same: str) -> None:
    assert not units.is_gauge(unit)
    assert units.parse(f"5 {unit}", "Pa") == units.parse(f"5 {same}", "Pa")


@pytest.mark.parametrize(
    ("unit", "si_unit", "meant"),
    [("PA", "Pa", "Pa"), ("BAR", "Pa", "bar"), ("kpa", "Pa", "kPa"), ("S", "s", "s"), ("MM", "m", "mm"), ("PSI", "m", None)],
)
def test_a_unit_in_the_wrong_case_is_asked_about(unit: str, si_unit: str, meant: str | None) -> None:
    with pytest.raises(UnitError) as caught:
        units.scale_and_offset(unit, si_unit)
    assert str(caught.value).endswith(f'did you mean "{meant}"?' if meant else f'write it like "{si_unit}"')


MAGNITUDES = st.floats(1e-45, 1e29)
SI_UNITS = ("m", "m^2", "m^3", "Pa", "K", "kg", "s", "N", "N*m", "rad", "1", "W/K")


@given(st.just(0.0) | MAGNITUDES | MAGNITUDES.map(lambda size: -size), st.sampled_from(SI_UNITS))
def test_what_is_written_is_read_back(value: float, si_unit: str) -> None:
    assert units.parse(units.write(value, si_unit), si_unit) == pytest.approx(value, rel=1e-14, abs=0.0)


@pytest.mark.parametrize(
    ("text", "powers"),
    [
        ("m", {"m": 1}),
        ("J/(kg K)", {"J": 1, "kg": -1, "K": -1}),
        ("J / kg / K", {"J": 1, "kg": -1, "K": -1}),
        ("J/kg K", {"J": 1, "kg": -1, "K": 1}),
        ("N*m", {"N": 1, "m": 1}),
        ("N·m", {"N": 1, "m": 1}),
        ("m²", {"m": 2}),
        ("m s⁻²", {"m": 1, "s": -2}),
        ("kg m^2 / s**3", {"kg": 1, "m": 2, "s": -3}),
        ("1/(m/s)^2", {"m": -2, "s": 2}),
        ("1/s", {"s": -1}),
        ("m/m", {"m": 0}),
    ],
)
def test_a_unit_is_a_product_of_powers(text: str, powers: dict[str, int]) -> None:
    assert unit_text.powers(text) == powers


@pytest.mark.parametrize(
    ("text", "si_unit", "scale"), [("N·m", "N*m", 1.0), ("kg m² / s²", "N*m", 1.0), ("mm²", "m^2", 1e-6), ("1/K", "1/K", 1.0)]
)
def test_units_as_people_write_them(text: str, si_unit: str, scale: float) -> None:
    assert units.scale_and_offset(text, si_unit) == (scale, 0.0)


UNIT_PIECES = st.sampled_from(
    ["m", "kg", "bar", "**", "^", "*", "/", "(", ")", "1", "10", "9", " ", "²", "⁻", "degC", "e", ".", "-", "\n", "%", "é"]
)  # fmt: skip


@given(st.lists(UNIT_PIECES, max_size=30).map("".join), st.sampled_from(["m", "Pa", "1", "J/(kg K)"]))
def test_whatever_is_written_as_a_unit_is_read_or_refused_in_one_line(unit: str, si_unit: str) -> None:
    try:
        scale, offset = units.scale_and_offset(unit, si_unit)
    except UnitError as error:
        assert len(str(error)) < 400
    else:
        assert math.isfinite(scale) and math.isfinite(offset)


@pytest.mark.parametrize(("unit", "si_unit"), [
    ("mm", "m"), ("cm^3", "m^3"), ("mm²", "m^2"), ("bar", "Pa"), ("kPa", "Pa"), ("g", "kg"), ("ms", "s"), ("kN", "N"), ("K", "K"),
    ("N*s/m", "N s/m"), ("N m/rad", "N*m/rad"), ("J/(kg K)", "J/(kg K)"), ("W/K", "W/K"), ("kg/(s Pa^2)", "kg/(s Pa^2)"), ("1/s", "1/s"),
    ("bar/s", "Pa/s"), ("mm/s", "m/s"), ("N/mm", "N/m"), ("J/s", "W"), ("N/m^2", "Pa"), ("cm^2/ms", "m^2/s"), ("kg m/s^2", "kN"),
])  # fmt: skip
def test_common_units_convert_as_the_library_of_all_units_does(unit: str, si_unit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    units.scale_and_offset.cache_clear()
    quick = units.scale_and_offset(unit, si_unit)
    units.scale_and_offset.cache_clear()
    monkeypatch.setattr(units, "_COMMON", {})
    assert units.scale_and_offset(unit, si_unit) == quick
    units.scale_and_offset.cache_clear()


def test_common_units_load_no_library() -> None:
    code = "import sys; from exo_sim import units; units.parse('3 bar', 'Pa'); units.parse('32 mm^2', 'm^2'); print('pint' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"


@pytest.mark.parametrize(("number", "unit", "meant"), [
    ("7", "Pa", "7 bar"), (7, "Pa", "7 bar"), ("700000", "Pa", "700000 Pa"), ("32", "m", "32 mm"),
    ("0.032", "m", "0.032 m"), (1.7, "m", "1.7 m"),
    ("3", "m^2", "3 mm^2"), ("2", "m^3", "2 l"), ("20", "K", "20 degC"), ("293", "K", "293 K"), ("34", "kg", "34 kg"),
])  # fmt: skip
def test_a_number_without_a_unit_is_answered_with_the_likely_one(number: object, unit: str, meant: str) -> None:
    with pytest.raises(UnitError, match=re.escape(f'like "{meant}"')):
        units.parse(number, unit)
    assert units.is_of(meant, unit)
