"""Known limits of valve lag: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.signal
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
        followed, _ = valve_lag.follow(lag, spool, 0.0, command, seconds)
        assert followed == pytest.approx(fine, abs=5e-4)  # what a step over the centre errs by


def test_spool_on_its_way_back_is_the_same_in_one_step_and_in_many() -> None:
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"], lag["closing_excess"] = 5e-3, 0.7
    spool = 0.8
    for _ in range(20):
        spool, _ = valve_lag.follow(lag, spool, 0.0, -0.6, 5e-4)
    assert spool == pytest.approx(valve_lag.follow(lag, 0.8, 0.0, -0.6, 1e-2)[0], rel=1e-12)


def test_spool_without_an_excess_is_the_first_order_to_the_last_bit() -> None:
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"] = 5e-3
    for spool, command in ((0.8, 0.1), (0.8, -0.5), (0.2, 0.9)):
        expected = command + (spool - command) * math.exp(-3e-3 / 5e-3)
        assert valve_lag.follow(lag, spool, 0.0, command, 3e-3) == (expected, 0.0)


@pytest.mark.parametrize("damping", [0.4, 0.8, 1.0, 1.3, 4.0])
def test_spool_with_mass_is_the_known_answer_of_second_order(damping: float) -> None:
    omega, step = 2.0 * math.pi * 40.0, 0.4
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"], lag["inertia"] = 2.0 * damping / omega, 1.0 / (4.0 * damping**2)
    system = scipy.signal.TransferFunction([omega**2], [1.0, 2.0 * damping * omega, omega**2])
    times = np.linspace(0.0, 0.05, 26)
    expected = step * scipy.signal.step(system, T=times)[1]
    spool = speed = 0.0
    for before, after, place in zip(times, times[1:], expected[1:], strict=False):
        spool, speed = valve_lag.follow(lag, spool, speed, step, after - before)
        assert spool == pytest.approx(place, abs=1e-9)


def test_spool_with_hardly_any_mass_is_of_first_order() -> None:
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"] = 5e-3
    first, _ = valve_lag.follow(lag, 0.7, 0.0, -0.2, 4e-3)
    apart = []
    for inertia in (1e-2, 1e-3):
        lag["inertia"] = inertia
        apart.append(abs(valve_lag.follow(lag, 0.7, (first - 0.7) / 5e-3, -0.2, 4e-3)[0] - first))
    assert apart[1] < 0.2 * apart[0] < 0.02


def test_spool_with_mass_stops_where_it_is_fully_open() -> None:
    lag = np.zeros(1, CYLINDER)["valve_lag"][0]
    lag["time_constant"], lag["inertia"] = 4e-3, 1.0
    assert valve_lag.follow(lag, 0.99, 300.0, 1.0, 2e-3) == (1.0, 0.0)


def test_spool_with_mass_moves_no_faster_than_its_limit() -> None:
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_lag"]["time_constant"], gas.cylinders["valve_lag"]["inertia"] = 5e-3, 0.7
    gas.cylinders["spool_rate_limit"]["rate"] = 20.0
    gas.fill(np.zeros(1), 2e5, 2e5)
    hold(gas, 0.9, 0.010)
    assert gas.memory[0, state.SPOOL] == pytest.approx(0.2, rel=0.05)
    assert gas.memory[0, state.SPOOL_SPEED] == pytest.approx(20.0)


@pytest.mark.parametrize("shape", ["closing_excess", "inertia"])
def test_a_shape_without_a_time_constant_is_refused(shape: str) -> None:
    check = valve_lag.EFFECT.check
    assert check is not None
    assert "time_constant" in check("cylinder", {"delay": 5e-3, shape: 0.5}, {})
    assert check("cylinder", {"time_constant": 5e-3, shape: 0.5}, {}) == check("cylinder", {"delay": 5e-3}, {}) == ""


def test_how_a_spool_changes_sides_says_nothing_without_a_closing_delay() -> None:
    check = valve_lag.EFFECT.check
    assert check is not None
    assert "closing_delay" in check("cylinder", {"delay": 5e-3, "reversal": 1.0}, {})
    assert check("cylinder", {"delay": 5e-3, "closing_delay": 4e-3, "reversal": 1.0}, {}) == ""


@pytest.mark.parametrize(("delay", "closing", "after"), [(3e-3, -2e-3, 1e-3), (3e-3, 8e-3, 11e-3), (0.0, 2e-3, 2e-3), (1e-3, -2e-3, 0.0)])
def test_no_valve_closes_before_it_is_told(delay: float, closing: float, after: float) -> None:
    record = np.zeros(1, CYLINDER)["valve_lag"]
    record["delay"], record["closing_delay"] = delay, closing
    assert valve_lag.let_go_after(record[0]) == pytest.approx(after, abs=1e-15)
