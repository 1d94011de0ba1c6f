from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim import units
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
    ],
)
def test_text_is_read_as_si(text: object, si_unit: str, value: float) -> None:
    assert units.parse(text, si_unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "si_unit", "says"),
    [
        ("5 barg", "Pa", "gauge"),
        ("5 bar gauge", "Pa", "gauge"),
        ("60 psig", "Pa", "gauge"),
        ("32", "m", "no unit"),
        (32, "m", "no unit"),
        ("32 furlongish", "m", "unknown unit"),
        ("32 kg", "m", "not a unit of this kind"),
        ("wide", "m", "not a quantity"),
        (True, "m", "not a quantity"),
        ("1e999 m", "m", "not finite"),
        ("3 kg", "1", "cannot be converted"),
    ],
)
def test_what_cannot_be_read_is_one_line_that_says_why(text: object, si_unit: str, says: str) -> None:
    with pytest.raises(UnitError, match=says) as caught:
        units.parse(text, si_unit)
    assert "\n" not in str(caught.value)


@given(st.floats(allow_nan=False, allow_infinity=False, width=32), st.sampled_from([*units.SI_UNITS.values(), "W/K"]))
def test_what_is_written_is_read_back(value: float, si_unit: str) -> None:
    assert units.parse(units.write(value, si_unit), si_unit) == pytest.approx(value, rel=1e-14, abs=0.0)
