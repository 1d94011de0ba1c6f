"""Bounds on how fast a volume settles are bounds: the true rate, from differences of the flow, is never above them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from exo_sim.physics import nozzle
from exo_sim.physics.settling import HOT, hot_gas, laminar_rate, path_rate, settling_rate, thermal_rate

K, R, V, AREA = 1.4, 287.05, 2e-5, 5e-6
GAS = hot_gas(K, R)


def true_rate(p: float, down: float) -> float:
    """Return the rate at which the pressure of a volume at HOT settles through a nozzle, from a difference [1/s]."""
    d = 1e-5 * p
    slope = (nozzle.mass_flow(AREA, p + d, HOT, down, K, R) - nozzle.mass_flow(AREA, p - d, HOT, down, K, R)) / (2 * d)
    return abs(float(slope)) * K * R * HOT / V


@pytest.mark.parametrize("ratio", np.linspace(0.1, 0.97, 12))
def test_a_path_settles_no_faster_than_its_bound(ratio: float) -> None:
    assert true_rate(5e5, 5e5 * ratio) <= 1.001 * path_rate(AREA, 5e5, 5e5 * ratio, V, 0.0, GAS)


def test_a_longer_span_may_lead_to_where_it_is_steeper() -> None:
    rates = [path_rate(AREA, 5e5, 3e5, V, span, GAS) for span in (0.0, 1e-3, 5e-3, 1.0)]
    assert rates == sorted(rates) and path_rate(0.0, 5e5, 3e5, V, 1.0, GAS) == 0.0


def test_a_choked_path_empties_in_its_time_constant() -> None:
    """-dm/dt = C m for a choked nozzle at constant temperature; times k for the pressure of an adiabatic volume, at most."""
    flow = nozzle.mass_flow(AREA, 5e5, HOT, 1e4, K, R) / (5e5 * V / (R * HOT))
    assert flow < settling_rate(AREA, V, GAS) < 3.0 * flow * K


def test_laminar_and_thermal_rates_are_slopes() -> None:
    conductance, p = 1e-15, 4e5
    assert laminar_rate(conductance, p, V, K, R) == pytest.approx(2.0 * conductance * p * K * R * HOT / V)
    mass_cv = p * V / (R * HOT) * R / (K - 1.0)
    assert thermal_rate(2.0, p, V, K) == pytest.approx(2.0 / mass_cv) and math.isfinite(thermal_rate(0.0, p, V, K))
