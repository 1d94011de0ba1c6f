"""Known limits of supply droop: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.air import PA, K
from physics.stepping import hold, tank

from exo_sim.physics import state


def test_accumulator_falls_isentropically() -> None:
    gas = tank(1e-3, 5e-6, dt=1e-3)
    gas.world["supply_droop"]["volume"] = 1e-3
    gas.fill(np.zeros(1), PA, PA)
    before = gas.vector[state.INTEGRATED + state.SUPPLY_MASS]
    hold(gas, 1.0, 0.07)
    y = gas.vector[state.INTEGRATED :]
    left = y[state.SUPPLY_MASS] / before
    assert gas.books().drawn[0] == pytest.approx(before * (1 - left), rel=1e-12)
    assert (K - 1) * y[state.SUPPLY_ENERGY] / 1e-3 == pytest.approx(7e5 * left**K, rel=1e-6)
    # one stroke of a 32 x 100 at 6 bar, 0.5734 g, costs a litre 0.6661 bar (B18)
    assert 7e5 * (1 - (1 - 0.5734e-3 / before) ** K) == pytest.approx(0.6661e5, abs=6.0)


def test_feed_refills_and_lets_nothing_back() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.world["supply_droop"]["volume"], gas.world["supply_droop"]["conductance"] = 1e-3, 1e-8
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 0.2)
    y = gas.vector[state.INTEGRATED :]
    fed = y[state.FED]
    assert fed > 0.0
    hold(gas, 0.0, 20.0)
    assert (K - 1) * y[state.SUPPLY_ENERGY] / 1e-3 == pytest.approx(7e5, rel=1e-6)
    gas.world["supply_pressure"] = 3e5
    more = y[state.FED]
    hold(gas, 0.0, 1.0)
    assert y[state.FED] == more
