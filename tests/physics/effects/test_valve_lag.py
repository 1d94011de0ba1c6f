"""Known limits of valve lag: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.stepping import hold, tank

from exo_sim.physics import state
from exo_sim.physics.pneumatics import Pneumatics


def test_delay_is_the_same_fill_later() -> None:
    late, paper = tank(5e-5, 5e-6, dt=1e-3), tank(5e-5, 5e-6, dt=1e-3)
    late.cylinders["valve_lag"]["delay"] = 7e-3
    late = Pneumatics(late.world, late.cylinders, dt=1e-3)
    for each, seconds in ((late, 0.037), (paper, 0.030)):
        each.fill(np.zeros(1), 2e5, 2e5)
        hold(each, 0.5, seconds)
    assert late.pressures(np.zeros(1)) == pytest.approx(paper.pressures(np.zeros(1)), rel=1e-9)


def test_spool_follows_in_first_order_whatever_the_step() -> None:
    for dt in (1e-3, 2.5e-4):
        gas = tank(5e-5, 5e-6, dt=dt)
        gas.cylinders["valve_lag"]["time_constant"] = 5e-3
        gas.fill(np.zeros(1), 2e5, 2e5)
        hold(gas, 0.8, 0.012)
        assert gas.memory[0, state.SPOOL] == pytest.approx(0.8 * (1 - math.exp(-12 / 5)), rel=1e-9)
