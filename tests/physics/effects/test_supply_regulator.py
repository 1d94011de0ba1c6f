"""Known limits of supply regulator: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.air import PA, K, R
from physics.stepping import hold, tank

from exo_sim.physics import nozzle, state


def test_droops_in_proportion_to_flow_and_recovers() -> None:
    gas = tank(1.0, 2e-6, dt=1e-3)
    gas.world["supply_regulator"]["droop"], gas.world["supply_regulator"]["time_constant"] = 2e7, 0.05
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 1.0)
    choked = nozzle.mass_flow(2e-6, 1.0, 293.15, 0.0, K, R)
    regulated = 7e5 / (1 + 2e7 * choked)
    held = gas.vector[state.INTEGRATED + state.SHARED + state.REMEMBERED + state.HELD]
    assert 7e5 - 2e7 * held == pytest.approx(regulated, rel=1e-6)
    hold(gas, 0.0, 1.0)
    held = gas.vector[state.INTEGRATED + state.SHARED + state.REMEMBERED + state.HELD]
    assert 2e7 * held == pytest.approx(0.0, abs=1e-3)


def test_sticks_by_half_its_hysteresis() -> None:
    gas = tank(1.0, 2e-6, dt=1e-3)
    gas.world["supply_regulator"]["droop"], gas.world["supply_regulator"]["hysteresis"] = 2e7, 2e4
    gas.fill(np.zeros(1), PA, PA)
    hold(gas, 1.0, 0.5)
    hold(gas, 0.0, 0.5)
    held = gas.vector[state.INTEGRATED + state.SHARED + state.REMEMBERED + state.HELD]
    assert 2e7 * held == pytest.approx(1e4, rel=1e-9)
