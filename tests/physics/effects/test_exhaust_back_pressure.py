"""Known limits of exhaust back pressure: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.air import PA, K
from physics.stepping import hold, tank
from scipy.optimize import brentq

from exo_sim.physics import state


def test_silencer_is_in_series_with_the_valve() -> None:
    for ratio, pressure in ((0.5, 350000.0), (1.0, 565220.830689), (2.0, 661091.836534)):
        gas = tank(30.0, 1e-6 * ratio, dt=1e-3)
        gas.world["exhaust_back_pressure"]["area"], gas.world["exhaust_back_pressure"]["volume"] = 1e-6, 2e-5
        gas.fill(np.zeros(1), 7e5, PA)
        hold(gas, -1.0, 2.0)
        y = gas.vector[state.INTEGRATED :]
        assert (K - 1) * y[state.EXHAUST_ENERGY] / 2e-5 == pytest.approx(pressure, rel=2e-4)  # the tank falls by 0.01 %


def test_a_silencer_with_a_ratio_of_its_own_follows_iso_6358() -> None:
    """What a choked valve of half its area passes needs half the pressure of the tank where it chokes as well; by the ellipse more."""
    gas, b = tank(30.0, 0.25e-6, dt=1e-3), 0.2
    silencer = gas.world["exhaust_back_pressure"]
    silencer["area"], silencer["volume"], silencer["ratio"] = 1e-6, 2e-5, b
    gas.fill(np.zeros(1), 7e5, PA)
    hold(gas, -1.0, 2.0)
    node = (K - 1) * gas.vector[state.INTEGRATED :][state.EXHAUST_ENERGY] / 2e-5
    expected = brentq(lambda p: p * np.sqrt(1.0 - ((PA / p - b) / (1.0 - b)) ** 2) - 175000.0, 1.2e5, 3e5)
    assert node == pytest.approx(expected, rel=2e-4) and expected > 1.05 * 175000.0
