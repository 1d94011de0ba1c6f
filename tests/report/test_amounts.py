import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.report import amounts


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [
        (9423.0, "Pa", "9.42 kPa"),
        (250.0, "Pa", "250 Pa"),
        (6.5e5, "Pa", "6.50 bar"),
        (2.4e-3, "m", "2.40 mm"),
        (3e-8, "m^2", "0.0300 mm²"),
        (0.0, "Pa", "0 Pa"),
        (math.nan, "Pa", "–"),
        (12.5, "N*m", "12.5 N m"),
        (1e-16, "kg/(s Pa^2)", "1.00 × 10⁻¹⁶ kg/(s Pa²)"),
        (0.83, "1", "0.830"),
    ],
)
def test_an_amount_is_shown_in_the_unit_that_is_read_most_easily(value, unit, words):
    assert amounts.amount(value, unit) == words


def test_an_interval_has_the_digits_that_its_width_allows():
    assert amounts.interval(3.62177e-8, 3.6172e-8, 3.6263e-8, "m^2") == ("0.036218 mm²", "0.036172 to 0.036263 mm²")
    assert amounts.interval(12.434, 11.0, 14.0, "N") == ("12.4 N", "11.0 to 14.0 N")
    assert amounts.interval(1e-16, 0.9e-16, 1.1e-16, "1")[1] == "9.0 × 10⁻¹⁷ to 1.10 × 10⁻¹⁶"


@given(st.floats(-1e12, 1e12), st.floats(0.0, 1e6), st.sampled_from(["Pa", "m", "1", "N*m", "kg/s", "strange"]))
def test_any_interval_can_be_shown(value, width, unit):
    shown, span = amounts.interval(value, value - width, value + width, unit)
    assert shown and " to " in span


@given(st.floats(allow_nan=True, allow_infinity=True), st.sampled_from(["Pa", "m^3", "", "1"]))
def test_any_number_can_be_shown(value, unit):
    assert amounts.amount(value, unit)


def test_shares_in_words():
    assert amounts.share(0.83) == "83 %"
    assert amounts.share(0.004) == "under 1 %"
    assert amounts.share(0.998) == "99.8 %"
    assert amounts.spans([(1.0, 1.5), (2.0, 2.25), (3.0, 4.0)], most=2) == "1–1.5 s, 2–2.25 s and 1 more"
