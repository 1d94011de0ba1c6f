"""Known limits of moving wall temperature: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.air import CV, R
from physics.stepping import hold, tank

from exo_sim.physics import state


def test_gas_and_wall_meet_in_the_middle() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.cylinders["wall_heat_transfer"]["conductance"] = 2.0
    gas.cylinders["moving_wall_temperature"]["heat_capacity"] = 1.5
    gas.fill(np.zeros(1), 6e5, 6e5, temperature=393.15)
    own = 6e5 * 1e-4 / (R * 393.15) * CV
    hold(gas, 0.0, 3.0)
    met = (own * 393.15 + 1.5 * 293.15) / (own + 1.5)
    assert gas.temperatures()[0] == pytest.approx(met, rel=1e-7)
    assert gas.integrated[0, state.WALL_1] == pytest.approx(met, rel=1e-7)


def test_warm_wall_cools_outwards() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    gas.cylinders["moving_wall_temperature"]["heat_capacity"] = 1.5
    gas.cylinders["moving_wall_temperature"]["outside_conductance"] = 3.0
    gas.fill(np.zeros(1), 6e5, 6e5)
    gas.integrated[0, state.WALL_1] = 313.15
    hold(gas, 0.0, 0.5)
    assert gas.integrated[0, state.WALL_1] - 293.15 == pytest.approx(20.0 * math.exp(-1.0), rel=1e-6)
