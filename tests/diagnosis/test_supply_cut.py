"""The supply cut: closed forms of tank and regulator, and which of the two sagged."""

from __future__ import annotations

import math

import numpy as np
import pytest

from exo_sim.diagnosis import supply_cut
from exo_sim.diagnosis.quantity import Setting
from exo_sim.diagnosis.search import Search
from exo_sim.diagnosis.split import split
from exo_sim.physics.records import CYLINDER, WORLD

TIME = np.arange(0.0, 12.0, 1e-3)
DRAWN = 2e-3 * (np.sin(2.0 * TIME) > 0.3) * (0.4 + 0.6 * (np.sin(0.7 * TIME) > 0.0))
SUPPLY, WARM, K, R = 7e5, 293.15, 1.4, 287.0


def setting(**effects: dict[str, float]) -> Setting:
    world = np.zeros(1, WORLD)
    world["supply_pressure"], world["supply_temperature"], world["k"], world["r"] = SUPPLY, WARM, K, R
    for effect, numbers in effects.items():
        for name, value in numbers.items():
            world[effect][name] = value
    return Setting(world, np.zeros(1, CYLINDER))


def problem(pressure: np.ndarray, drawn: np.ndarray = DRAWN) -> supply_cut.SupplyProblem:
    parts = split([("recording", TIME)])
    return supply_cut.SupplyProblem([supply_cut.supply_run("recording", TIME, pressure, drawn)], setting(), parts)


def supplied(machine: Setting, drawn: np.ndarray = DRAWN) -> np.ndarray:
    out = np.empty(TIME.size)
    supply_cut.follow_supply(machine.world, TIME, drawn, 0.0, out)
    return out


def test_a_tank_without_feed_empties_along_the_adiabat() -> None:
    volume = 5e-3
    pressure = supplied(setting(supply_droop={"volume": volume, "conductance": 0.0}))
    mass = SUPPLY * volume / (R * WARM)
    left = mass - float(np.sum(DRAWN[:-1]) * 1e-3)
    assert pressure[-1] == pytest.approx(SUPPLY * (left / mass) ** K, rel=2e-3)


def test_a_fed_tank_settles_where_the_feed_is_what_is_drawn() -> None:
    steady = np.full(TIME.size, 1e-3)
    pressure = supplied(setting(supply_droop={"volume": 1e-3, "conductance": 2e-8}), steady)
    assert pressure[-1] == pytest.approx(SUPPLY - 1e-3 / 2e-8, rel=1e-3)


def test_a_regulator_droops_with_its_time_constant() -> None:
    steady = np.full(TIME.size, 1e-3)
    pressure = supplied(setting(supply_regulator={"droop": 3e7, "time_constant": 0.1}), steady)
    assert pressure[-1] == pytest.approx(SUPPLY - 3e4, rel=1e-6)
    assert pressure[100] == pytest.approx(SUPPLY - 3e4 * (1.0 - math.exp(-1.0)), rel=1e-4)


@pytest.mark.parametrize(
    ("effect", "numbers"),
    [
        ("supply_droop", {"volume": 2e-3, "conductance": 4e-8}),
        ("supply_regulator", {"droop": 4e7, "time_constant": 0.08}),
    ],
    ids=["droop", "regulator"],
)
def test_what_sagged_is_named(effect: str, numbers: dict[str, float]) -> None:
    noise = np.random.default_rng(5).normal(0.0, 250.0, TIME.size)
    one = problem(supplied(setting(**{effect: numbers})) + noise)
    found = Search(one, supply_cut.believed(one.setting), supply_cut.candidates(one.setting), cheap=True, material=one.material).run()
    assert [candidate.effect for candidate in found.end.chosen] == [effect]
    for quantity, value in found.end.fit.values.items():
        if quantity.parameter in numbers:
            assert value == pytest.approx(numbers[quantity.parameter], rel=0.05)


def test_a_steady_supply_has_nothing_to_name() -> None:
    noise = np.random.default_rng(6).normal(0.0, 250.0, TIME.size)
    one = problem(np.full(TIME.size, 1.004 * SUPPLY) + noise)
    found = Search(one, supply_cut.believed(one.setting), supply_cut.candidates(one.setting), cheap=True, material=one.material).run()
    assert not found.end.chosen
