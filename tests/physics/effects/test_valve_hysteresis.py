"""Known limits of valve hysteresis: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import hold, tank

from exo_sim.physics import state


def test_loop_is_as_wide_as_its_width() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_hysteresis"]["width"] = 0.06
    gas.fill(np.zeros(1), 2e5, 2e5)
    spools = []
    for command in (0.5, 0.3, -0.5, 0.3):
        hold(gas, command, 0.002)
        spools.append(gas.memory[0, state.SPOOL])
    assert spools == pytest.approx([0.47, 0.33, -0.47, 0.27], abs=1e-15)
    assert spools[1] - spools[3] == pytest.approx(0.06)


def test_command_that_is_over_before_the_spool_followed_leaves_no_trace() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-4)
    gas.cylinders["valve_hysteresis"]["width"] = 0.02
    gas.cylinders["valve_lag"]["time_constant"] = 0.01
    gas.fill(np.zeros(1), 2e5, 2e5)
    hold(gas, -0.6, 0.2)
    hold(gas, 0.6, 1e-3)
    hold(gas, 0.0, 0.2)
    assert gas.memory[0, state.SPOOL] == pytest.approx(-0.01, abs=1e-8)


def test_slow_spool_is_held_where_it_is_and_lags_behind_the_edge_of_its_loop_on_a_ramp() -> None:
    width, lag, speed = 0.02, 0.01, 0.5
    gas = tank(5e-5, 5e-6, dt=1e-4)
    gas.cylinders["valve_hysteresis"]["width"], gas.cylinders["valve_lag"]["time_constant"] = width, lag
    gas.fill(np.zeros(1), 2e5, 2e5)
    for n in range(1000):
        hold(gas, speed * n * 1e-4, 1e-4)
    top, last = gas.memory[0, state.SPOOL], speed * 999 * 1e-4
    assert top == pytest.approx(last - 0.5 * width - speed * lag, abs=speed * 1e-4)
    hold(gas, top - 0.4 * width, 0.1)
    assert gas.memory[0, state.SPOOL] == top
