"""The polynomial of air's flow factor against the power that it stands for."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.physics import nozzle, subsonic_air


def _without_cancelling(ratio: float) -> float:
    """Return gamma of equation 26 with the difference of its two powers taken as one exponential."""
    less = ratio * math.expm1((1.0 / subsonic_air.K - 1.0) * math.log(ratio))
    return math.sqrt(2.0 / (subsonic_air.K - 1.0) * ratio ** (1.0 / subsonic_air.K) * less)


@given(st.floats(subsonic_air.CHOKES, 0.9999))
def test_it_is_the_power_to_rounding(ratio: float) -> None:
    assert subsonic_air.flow_factor(ratio) == pytest.approx(_without_cancelling(ratio), rel=4e-15)
    assert subsonic_air.flow_factor(ratio) == pytest.approx(nozzle.subsonic_flow_factor(ratio, subsonic_air.K), rel=4e-12)


def test_it_meets_choked_flow() -> None:
    assert subsonic_air.flow_factor(subsonic_air.CHOKES) == pytest.approx(float(Fraction(125, 216)), rel=1e-15)
