"""The rates of a cylinder's gas: what one volume loses another or the books gain, and the paper's equations where nothing is added."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import bench

from exo_sim.physics import nozzle, state
from exo_sim.physics.balances import cylinder_rates
from exo_sim.physics.conditions import Reservoir
from exo_sim.physics.pneumatics import Pneumatics

SUPPLY, EXHAUST = Reservoir(7e5, 293.15), Reservoir(101325.0, 293.15)
K, R = 1.4, 287.05


def rates(gas: Pneumatics, opening: float, v: float = 0.0) -> np.ndarray:
    dy = np.zeros(state.integrated_size(1))
    cylinder_rates(gas.world[0], gas.cylinders[0], gas.vector[: dy.size], dy, 0, 0.05, v, opening, -opening, SUPPLY, EXHAUST)
    return dy


def test_an_open_valve_fills_one_chamber_and_empties_the_other_at_the_nozzles_flow() -> None:
    gas = bench(p_1=3e5, p_2=4e5)
    dy = rates(gas, 0.5)
    into = nozzle.mass_flow(2.5e-6, 7e5, 293.15, 3e5, K, R)
    out = nozzle.mass_flow(2.5e-6, 4e5, 293.15, 101325.0, K, R)
    assert dy[state.MASS_1] == pytest.approx(into) == dy[state.DRAWN]
    assert dy[state.MASS_2] == pytest.approx(-out) and dy[state.EXHAUSTED] == pytest.approx(out)
    cp = K * R / (K - 1)
    assert dy[state.ENERGY_1] == pytest.approx(into * cp * 293.15) and dy[state.ENERGY_2] == pytest.approx(-out * cp * 293.15)


def test_a_moving_piston_between_closed_chambers_only_works() -> None:
    gas = bench(p_1=5e5, p_2=3e5)
    dy, c = rates(gas, 0.0, 0.2), gas.cylinders[0]
    assert dy[state.MASS_1] == dy[state.MASS_2] == dy[state.DRAWN] == 0.0
    assert dy[state.ENERGY_1] == pytest.approx(-5e5 * c["area_1"] * 0.2) and dy[state.ENERGY_2] == pytest.approx(3e5 * c["area_2"] * 0.2)
    assert dy[state.WORK] == pytest.approx(-(dy[state.ENERGY_1] + dy[state.ENERGY_2]))


@pytest.mark.parametrize(("effect", "number", "value"), [("piston_leakage", "area", 3e-7), ("external_leakage", "area_1", 3e-7),
                                                         ("wall_heat_transfer", "conductance", 2.0)])  # fmt: skip
def test_whatever_is_added_the_books_gain_what_the_chambers_lose(effect: str, number: str, value: float) -> None:
    gas = bench(p_1=6e5, p_2=2e5)
    gas.fill(np.array([0.05]), 6e5, 2e5, temperature=330.0)
    gas.cylinders[effect][number] = value
    dy = rates(gas, 0.3, 0.1)
    mass = dy[state.MASS_1] + dy[state.MASS_2] - dy[state.DRAWN] + dy[state.EXHAUSTED] + dy[state.LEAKED]
    energy = dy[[state.ENERGY_1, state.ENERGY_2, state.EXHAUSTED_ENTHALPY, state.LEAKED_ENTHALPY, state.WORK]].sum()
    assert mass == pytest.approx(0.0, abs=1e-15)
    assert energy == pytest.approx(dy[state.DRAWN_ENTHALPY] + dy[state.HEAT], rel=1e-12)
