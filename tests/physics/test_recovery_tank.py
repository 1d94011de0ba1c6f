"""Gas between chambers and a recovery tank, against the balances of two adiabatic volumes."""

import numpy as np
import pytest

from exo_sim.physics import state
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world

P_T, V_T, K, R, T_A = 3e5, 2e-3, 1.4, 287.05, 293.15
AT = np.array([0.05])


def plant(p_1, p_2, hose=0.0):
    world, cylinder = paper_world(9e5), paper_cylinder(0.050, 0.020, 0.1, 10e-6, 1e-5, 1e-5)
    world["tank_volume"], world["tank_pressure"] = V_T, P_T
    cylinder["independent"], cylinder["tank_area"] = 1.0, 10e-6
    if hose:
        cylinder["line_restriction"]["area"], cylinder["line_restriction"]["volume"] = 8e-6, hose
    gas = Pneumatics(world, cylinder, dt=1e-3)
    gas.fill(AT, p_1, p_2)
    return gas


def tank(gas):
    mass, energy = gas.vector[state.INTEGRATED + state.TANK_MASS], gas.vector[state.INTEGRATED + state.TANK_ENERGY]
    return (K - 1.0) * energy / V_T, mass


def held(gas, command, seconds):
    for _ in range(round(seconds / gas.dt)):
        gas.advance(AT, AT, np.array(command))


@pytest.mark.parametrize("hose", [0.0, 6e-6])
@pytest.mark.parametrize("p_1", [8e5, 1.2e5])
def test_an_open_path_levels_chamber_and_tank_and_keeps_all_gas_and_energy(p_1, hose):
    gas = plant(p_1, P_T, hose)
    (v_1, _), mass = np.array([1e-5 + gas.cylinders[0]["area_1"] * 0.05, 0.0]), tank(gas)[1]
    held(gas, [0.0, 0.0, 1.0, 0.0], 1.0)
    p = (p_1 * (v_1 + hose) + P_T * V_T) / (v_1 + hose + V_T)  # internal energy is p V / (k - 1)
    assert gas.pressures(AT)[0, 0] == pytest.approx(p, rel=2e-3)
    assert tank(gas)[0] == pytest.approx(p, rel=2e-3)
    assert gas.pressures(AT)[0, 1] == P_T
    books = gas.books()
    assert books.recovered == pytest.approx(tank(gas)[1] - mass)
    assert np.sign(books.recovered) == np.sign(p_1 - P_T)
    assert books.drawn[0] == 0.0
    assert abs(gas.integrated[0, [state.MASS_1, state.HOSE_MASS_1]].sum() + tank(gas)[1] - (p_1 * (v_1 + hose) / (R * T_A) + mass)) < 1e-15


def test_a_path_at_rest_or_commanded_shut_lets_nothing_through():
    gas = plant(8e5, 1.2e5)
    before = gas.vector[: state.integrated_size(1)].copy()
    held(gas, [0.0, 0.0, -1.0, 0.0], 0.1)
    assert np.array_equal(gas.vector[: state.integrated_size(1)], before)


def test_what_the_other_edges_do_meanwhile_is_in_the_books():
    gas = plant(2e5, 8e5)
    held(gas, [1.0, -1.0, 1.0, 1.0], 0.02)
    held(gas, [-0.5, 0.3, 0.7, 0.0], 0.05)
    books = gas.books()
    assert books.drawn[0] > 0.0 and books.recovered != 0.0
    assert books.mass_residual < 1e-13 and books.energy_residual < 1e-13
