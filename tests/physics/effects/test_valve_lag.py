"""Known limits of valve lag: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.stepping import hold, tank

from exo_sim.physics import state
from exo_sim.physics.effects import valve_lag
from exo_sim.physics.plant_records import CYLINDER
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


def _path(spool: float, command: float, time_constant: float, excess: float, seconds: float) -> float:
    """Return where a spool is that was followed in steps of a microsecond."""
    h = 1e-6
    for _ in range(round(seconds / h)):
        closes = (command - spool) * spool < 0.0
        spool += h * (command - spool) / (time_constant * (1.0 + excess if closes else 1.0))
    return spool


@pytest.mark.parametrize("excess", [1.0, -0.6])
@pytest.mark.parametrize(("spool", "command"), [(0.8, 0.1), (0.8, 0.0), (0.8, -0.5), (-0.3, 0.9), (0.2, 0.9), (-0.2, -0.9), (0.0, 0.5)])
def test_spool_goes_back_to_its_centre_with_a_lag_of_its_own(spool: float, command: float, excess: float) -> None:
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"], lag["closing_excess"] = 5e-3, excess
    for seconds in (1e-3, 4e-3, 2e-2):
        fine = _path(spool, command, 5e-3, excess, seconds)
        assert valve_lag.follow(lag, spool, command, seconds) == pytest.approx(fine, abs=5e-4)  # what a step over the centre errs by


def test_spool_on_its_way_back_is_the_same_in_one_step_and_in_many() -> None:
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"], lag["closing_excess"] = 5e-3, 0.7
    spool = 0.8
    for _ in range(20):
        spool = valve_lag.follow(lag, spool, -0.6, 5e-4)
    assert spool == pytest.approx(valve_lag.follow(lag, 0.8, -0.6, 1e-2), rel=1e-12)


def test_spool_without_an_excess_is_the_first_order_to_the_last_bit() -> None:
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"] = 5e-3
    for spool, command in ((0.8, 0.1), (0.8, -0.5), (0.2, 0.9)):
        assert valve_lag.follow(lag, spool, command, 3e-3) == command + (spool - command) * math.exp(-3e-3 / 5e-3)


def test_an_excess_without_a_time_constant_is_refused() -> None:
    check = valve_lag.EFFECT.check
    assert check is not None
    assert "time_constant" in check("cylinder", {"delay": 5e-3, "closing_excess": 0.5}, {})
    assert check("cylinder", {"time_constant": 5e-3, "closing_excess": 0.5}, {}) == check("cylinder", {"delay": 5e-3}, {}) == ""
