"""Predictions of a gas: the card of the pressures has a clock of its own, and what settles at once is not resolved."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.cylinder_runs import STEP, run_of
from numpy.typing import NDArray

from exo_sim.diagnosis.subsystems.gas.inputs import GasInputs, inputs
from exo_sim.diagnosis.subsystems.gas.prediction import EACH_EFFORT, SETTLED, effort_of, resolved, run_gas, shows_waves
from exo_sim.physics.plant_records import CYLINDER, WORLD
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder
from exo_sim.physics.settling import hot_gas, settling_rate

N = 1500


def machine(hose_area: float = 0.0, hose_volume: float = 0.0) -> tuple[NDArray[np.void], NDArray[np.void]]:
    world, cylinder = np.zeros(1, WORLD), np.zeros(1, CYLINDER)
    world["k"], world["r"], world["atmosphere"], world["ambient"] = 1.4, 287.05, 101325.0, 293.15
    world["supply_pressure"], world["supply_temperature"], world["exhaust_pressure"] = 7e5, 293.15, 101325.0
    cylinder["area_1"], cylinder["area_2"], cylinder["stroke"], cylinder["valve_area"] = 8e-4, 7e-4, 0.2, 2e-6
    cylinder["dead_volume_1"] = cylinder["dead_volume_2"] = 2e-5
    cylinder["line_restriction"]["area"], cylinder["line_restriction"]["volume"] = hose_area, hose_volume
    return world, cylinder


def given(world: NDArray[np.void]) -> GasInputs:
    time = np.arange(N) * STEP
    level = np.full(N, 3e5)
    run = run_of(level, level, length=0.1 + 0.03 * np.sin(9.0 * time), command=np.where(np.sin(5.0 * time) > 0.3, 0.6, 0.0))
    return inputs(run, world, 10.0)  # one window: what leads in where a valve's command was recorded would start it anew


def test_a_late_card_shows_the_same_pressures_later() -> None:
    world, cylinder = machine()
    feed, late = given(world), 40
    prompt = run_gas(feed, world, cylinder).pressure
    delayed = run_gas(feed, world, cylinder, card_delay=late * STEP).pressure
    np.testing.assert_allclose(delayed[late + 1 :], prompt[1 : N - late], rtol=2e-3)


@pytest.mark.parametrize("delay", [0.0005, 0.002, 0.0044])
def test_a_slow_logger_s_switched_valve_is_followed_to_when_the_command_arrives(delay: float) -> None:
    """At 200 Hz as at 10 kHz: the mean of both commands within a step would shut a valve that is thrown over."""
    world, cylinder = machine()
    cylinder["valve_deadband"]["width"], cylinder["valve_lag"]["delay"] = 0.2, delay
    period, often, level = 5e-3, 50, np.full(200, 3e5)
    command = np.repeat([1.0, -1.0, 1.0, 0.0, -1.0], 40)
    slow = run_of(level, level, time=np.arange(200) * period, command=command, commanded=True)
    many = np.repeat(level, often)
    quick = run_of(many, many, time=np.arange(200 * often) * period / often, command=np.repeat(command, often), commanded=True)
    seen = run_gas(inputs(slow, world, 10.0), world, cylinder).pressure
    np.testing.assert_allclose(seen, run_gas(inputs(quick, world, 10.0), world, cylinder).pressure[::often], rtol=2e-4)


@pytest.mark.parametrize("area", [4e-6, 2e-5])
def test_a_hose_that_settles_at_once_is_no_other_than_one_that_settles_within_a_row(area: float) -> None:
    """The rows of a fit take 5 ms; what is stored in the hose is stored in the chamber instead."""
    world, cylinder = machine(area, 2e-7)
    least = settling_rate(area, 1.0, hot_gas(1.4, 287.05)) * SETTLED
    assert least > 2e-7
    wide, explicit = machine(area, least)[1], machine(area, 2e-7)[1]
    for side in ("dead_volume_1", "dead_volume_2"):
        wide[side] = np.maximum(wide[side] - (least - 2e-7), 0.5 * wide[side])
    feed = given(world)
    np.testing.assert_array_equal(run_gas(feed, world, cylinder).pressure, run_gas(feed, world, wide).pressure)
    assert explicit["line_restriction"]["volume"][0] == cylinder["line_restriction"]["volume"][0] == 2e-7  # what was handed in stays


@pytest.mark.parametrize("valves", [1.0, 3.0, 10.0])
def test_how_much_a_silencer_holds_that_settles_at_once_hardly_shows(valves: float) -> None:
    """Of one that holds 2 cm^3 and is as wide as ten valves it shows most: what is drawn back from it comes as cold as it left."""
    world, cylinder = machine()
    silencer, feed = world["exhaust_back_pressure"], given(world)
    silencer["area"], silencer["volume"] = 2e-6 * valves, 2e-6
    widened = run_gas(feed, world, cylinder).pressure
    gas, seen = Pneumatics(world, cylinder, dt=STEP), np.empty((N, 2))
    gas.fill(feed.length[:1], 3e5, 3e5)
    for i in range(N):
        if i:
            gas.advance(feed.length[i - 1 : i], feed.length[i : i + 1], feed.command[i - 1 : i])
        seen[i] = gas.pressures(feed.length[i : i + 1])[0]
    assert np.sqrt(np.mean((widened - seen) ** 2)) < 1.5e-3 * np.mean(seen[:, 1])
    silencer["volume"] = settling_rate(2e-6 * valves, 1.0, hot_gas(1.4, 287.05)) * SETTLED
    if silencer["volume"][0] > 2e-6:
        np.testing.assert_array_equal(run_gas(feed, world, cylinder).pressure, widened)


def test_a_hose_costs_more_of_an_effort_and_most_behind_it_and_of_a_slow_logger() -> None:
    plain, hose, sensed = machine()[1], machine(4e-6, 5e-6)[1], machine(4e-6, 5e-6)[1]
    sensed["line_restriction"]["sensor"] = 1.0
    quick, slow = (100, 0.001), (100, 0.02)
    assert [effort_of(*quick, one) - EACH_EFFORT for one in (plain, hose, sensed)] == [100, 200, 300]
    assert [effort_of(*slow, one) - EACH_EFFORT for one in (plain, hose, sensed)] == [100, 800, 800]


@pytest.mark.parametrize(
    ("length", "area", "period", "shown"),
    [(2.0, 8e-6, 1e-3, True), (0.4, 8e-6, 1e-3, False), (2.0, 8e-6, 2e-2, False), (2.0, 1e-8, 1e-3, False), (0.0, 8e-6, 1e-3, False)],
    ids=["a long hose", "one that sound passes in a millisecond", "a slow logger", "a throttle like a pinhole", "no length"],
)
def test_waves_are_followed_where_a_fit_shows_them(length: float, area: float, period: float, shown: bool) -> None:
    """Nothing else costs the short steps that waves ask for, nor counts as if it did."""
    cylinder = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    cylinder["line_restriction"]["area"], cylinder["line_restriction"]["volume"] = area, 4e-5
    cylinder["line_restriction"]["length"] = length
    assert shows_waves(cylinder, resolved(period)) is shown
    plain = cylinder.copy()
    plain["line_restriction"]["length"] = 0.0
    more = effort_of(1000, period, cylinder) - effort_of(1000, period, plain)
    assert more > 0 if shown else more == 0
