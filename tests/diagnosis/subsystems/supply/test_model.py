"""The supply: closed forms of tank and regulator, and which of the two sagged."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
import pytest

from exo_sim.diagnosis.data.split import split
from exo_sim.diagnosis.estimation.parameters import PlantParameters
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.selection.fitted_model import FittedModel
from exo_sim.diagnosis.selection.search import Search
from exo_sim.diagnosis.subsystems.gas.model import GasModel
from exo_sim.diagnosis.subsystems.supply.candidates import candidates, nuisance_parameters
from exo_sim.diagnosis.subsystems.supply.model import SupplyModel, SupplyRun
from exo_sim.diagnosis.subsystems.supply.prediction import follow_supply
from exo_sim.physics.plant_records import CYLINDER, WORLD
from exo_sim.recording.noise import white_noise

TIME = np.arange(0.0, 12.0, 1e-3)
DRAWN = 2e-3 * (np.sin(2.0 * TIME) > 0.3) * (0.4 + 0.6 * (np.sin(0.7 * TIME) > 0.0))
SUPPLY, WARM, K, R = 7e5, 293.15, 1.4, 287.0


def setting(**effects: dict[str, float]) -> PlantParameters:
    world = np.zeros(1, WORLD)
    world["supply_pressure"], world["supply_temperature"], world["k"], world["r"] = SUPPLY, WARM, K, R
    for effect, numbers in effects.items():
        for name, value in numbers.items():
            world[effect][name] = value
    return PlantParameters(world, np.zeros(1, CYLINDER))


def problem(pressure: np.ndarray, drawn: np.ndarray = DRAWN) -> SupplyModel:
    parts = split([("recording", TIME)])
    return SupplyModel([SupplyRun("recording", TIME, pressure, drawn, white_noise(pressure))], setting(), parts)


def found_in(model: SupplyModel) -> FittedModel:
    asked = candidates(model.nominal)
    significant = model.practical_significance
    return Search(model, nuisance_parameters(model.nominal), asked, cheap=True, practical_significance=significant).run().final


def supplied(machine: PlantParameters, drawn: np.ndarray = DRAWN) -> np.ndarray:
    out = np.empty(TIME.size)
    follow_supply(machine.world, TIME, drawn, 0.0, out)
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
    found = found_in(one)
    assert [candidate.effect for candidate in found.candidates] == [effect]
    for quantity, value in found.fit.values.items():
        if quantity.parameter in numbers:
            assert value == pytest.approx(numbers[quantity.parameter], rel=0.05)


@pytest.mark.parametrize(
    ("name", "numbers", "twin"),
    [
        ("supply_droop", {"volume": 5.9e-5, "conductance": 8.6e-9}, "supply_regulator"),
        ("supply_droop", {"volume": 2e-3, "conductance": 4e-8}, ""),
        ("supply_regulator", {"droop": 1.2e8, "time_constant": 0.06}, "supply_droop"),
        ("supply_regulator", {"droop": 1.2e8, "time_constant": 0.06, "hysteresis": 8e3}, ""),
    ],
    ids=["58 ms", "0.42 s", "a regulator", "that sticks"],
)
@pytest.mark.parametrize("is_measured", [True, False])
def test_a_tank_is_like_a_regulator_that_can_be_as_slow(name: str, numbers: dict[str, float], twin: str, is_measured: bool) -> None:
    """Both are one first order between flow and pressure, and the flow is not known to the percent that the gas of a tank cools by."""
    found = {key: Estimate(value, "", 0.0, 1.0) for key, value in numbers.items()}
    finding = Finding(name, "supply", Kind.MISSING_PHYSICS, "", found, 9.0, 0.0)
    model = problem(supplied(setting(**{name: numbers})))
    if is_measured:
        said = model.indistinguishable([finding], found_in(model).fit)
    else:
        said = GasModel.indistinguishable(cast(GasModel, model), [finding], found_in(model).fit)
    expected = twin or ("supply_droop" if name == "supply_regulator" and not is_measured else "")
    assert said == ({(name, "supply"): (expected,)} if expected else {})


def test_a_steady_supply_has_nothing_to_name() -> None:
    noise = np.random.default_rng(6).normal(0.0, 250.0, TIME.size)
    one = problem(np.full(TIME.size, 1.004 * SUPPLY) + noise)
    found = found_in(one)
    assert not found.candidates
