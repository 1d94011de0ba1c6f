"""The pressure upstream of the valves: nothing drawn changes nothing, and an offset is an offset."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from exo_sim.diagnosis.subsystems.supply.prediction import follow_supply
from exo_sim.physics.plant_records import WORLD

TIME = np.arange(0.0, 2.0, 1e-3)


def followed(drawn: np.ndarray, effects: Mapping[str, Mapping[str, float]], offset: float = 0.0) -> np.ndarray:
    world = np.zeros(1, WORLD)
    world["supply_pressure"], world["supply_temperature"], world["k"], world["r"] = 7e5, 293.15, 1.4, 287.05
    for effect, numbers in effects.items():
        for name, value in numbers.items():
            world[effect][name] = value
    out = np.empty(TIME.size)
    follow_supply(world, TIME, drawn, offset, out)
    return out


TANK = {"supply_droop": {"volume": 2e-3, "conductance": 4e-8}}
REGULATOR = {"supply_regulator": {"droop": 3e7, "time_constant": 0.1}}


@pytest.mark.parametrize("effects", [{}, TANK, REGULATOR, {**TANK, **REGULATOR}], ids=["constant", "tank", "regulator", "both"])
def test_a_supply_that_nobody_draws_from_stays_at_its_set_pressure(effects: dict[str, dict[str, float]]) -> None:
    np.testing.assert_allclose(followed(np.zeros(TIME.size), effects, 1e4), 7.1e5, rtol=1e-9)


def test_a_constant_supply_feels_no_flow() -> None:
    assert (followed(np.full(TIME.size, 1e-3), {}) == 7e5).all()


def test_behind_a_tank_a_regulator_droops_by_the_mean_flow() -> None:
    """Fed 1 g/s through a conductance behind a droop: both falls add up."""
    tank = {"supply_droop": {"volume": 2e-4, "conductance": 4e-8}}  # settles within 0.05 s
    end = followed(np.full(TIME.size, 1e-3), {**tank, **REGULATOR})[-1]
    assert end == pytest.approx(7e5 - 3e7 * 1e-3 - 1e-3 / 4e-8, rel=2e-3)
