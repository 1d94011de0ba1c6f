"""Plans of chamber pressures against closed forms and against what any other way of giving the force would draw."""

import numpy as np
import pytest

from exo_sim.control.pressure_plan import plan
from exo_sim.physics.pneumatics import paper_cylinder, paper_world

P_S, P_A, K, R, T = 11e5, 101325.0, 1.4, 287.05, 293.15
PHASE = np.arange(64) / 64


def cylinder(area=20e-6, dead=1e-5):
    found = paper_cylinder(0.050, 0.020, 0.150, area, dead, dead)
    found["independent"] = 1.0
    return found[0]


def volumes(c, x):
    return c["dead_volume_1"] + c["area_1"] * x, c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x)


def drawn(volume, pressure):
    """What a chamber draws over a cycle whatever its pressures, filled at the supply's temperature [kg]."""
    after, later = np.roll(volume, -1), np.roll(pressure, -1)
    rate = 0.5 * (volume + after) * (later - pressure) + K * 0.5 * (pressure + later) * (after - volume)
    return float(np.maximum(rate, 0.0).sum() / (K * R * T))


@pytest.mark.parametrize("x", [0.03, 0.12])
def test_a_rod_that_is_still_is_steered_by_the_chamber_with_the_smaller_volume_for_its_area(x):
    c = cylinder()
    force = 500.0 + 200.0 * np.sin(2 * np.pi * PHASE)
    found = plan(paper_world(P_S)[0], c, np.full(64, x), force, 1.0)
    v_1, v_2 = volumes(c, x)
    assert found.gas == pytest.approx(np.ptp(force) * min(v_1 / c["area_1"], v_2 / c["area_2"]) / (K * R * T), rel=1e-3)


def test_a_force_that_shut_in_gas_would_give_costs_nothing():
    c = cylinder()
    x = 0.08 + 0.02 * np.sin(2 * np.pi * PHASE)
    v_1, v_2 = volumes(c, x)
    p_1, p_2 = 5e5 * (v_1[0] / v_1) ** K, 3e5 * (v_2[0] / v_2) ** K
    force = p_1 * c["area_1"] - p_2 * c["area_2"] - P_A * (c["area_1"] - c["area_2"])
    found = plan(paper_world(P_S)[0], c, x, force, 1.0)
    assert found.short == 0.0
    assert found.gas < 2e-6  # intervals are not infinitely short


def test_the_force_is_given_within_the_bounds_and_for_less_than_with_the_idle_chamber_let_off():
    c, force = cylinder(), 400.0 * np.sin(2 * np.pi * PHASE) + 250.0 * np.sin(4 * np.pi * PHASE + 1.0)
    x = 0.08 + 0.03 * np.cos(2 * np.pi * PHASE)
    found = plan(paper_world(P_S)[0], c, x, force, 1.0)
    rod = P_A * (c["area_1"] - c["area_2"])
    given = found.pressure_1 * c["area_1"] - found.pressure_2 * c["area_2"] - rod
    assert np.allclose(given, force, atol=1e-3)
    assert min(found.pressure_1.min(), found.pressure_2.min()) >= P_A - 1.0
    assert max(found.pressure_1.max(), found.pressure_2.max()) <= P_S
    v_1, v_2 = volumes(c, x)
    assert found.gas <= drawn(v_1, found.pressure_1) + drawn(v_2, found.pressure_2) + 1e-9
    p_1 = np.where(force >= 0.0, (force + rod + P_A * c["area_2"]) / c["area_1"], P_A)
    p_2 = np.where(force < 0.0, (P_A * c["area_1"] - rod - force) / c["area_2"], P_A)
    assert found.gas < 0.8 * (drawn(v_1, p_1) + drawn(v_2, p_2))


def test_what_a_small_valve_cannot_give_is_told():
    force = 900.0 * np.sin(2 * np.pi * PHASE)
    x = np.full(64, 0.08)
    assert plan(paper_world(P_S)[0], cylinder(0.5e-6), x, force, 0.5).short > 100.0
    assert plan(paper_world(P_S)[0], cylinder(60e-6), x, force, 0.5).short == 0.0


def test_forces_beyond_the_supply_are_given_as_far_as_it_goes():
    c = cylinder()
    most = 0.97 * P_S * c["area_1"] - P_A * c["area_1"]
    found = plan(paper_world(P_S)[0], c, np.full(64, 0.08), np.full(64, most + 300.0), 1.0)
    assert found.short == pytest.approx(300.0, rel=1e-3)


def with_tank(pressure=3e5):
    world, c = paper_world(P_S), cylinder()
    world["tank_volume"], world["tank_pressure"], c["tank_area"] = 2e-3, pressure, c["valve_area"]
    return world[0], c


def test_a_tank_saves_gas_and_gets_no_less_than_it_gives():
    world, c = with_tank()
    x, force = np.full(64, 0.08), 500.0 + 500.0 * np.sin(2 * np.pi * PHASE)
    plain, found = plan(paper_world(P_S)[0], cylinder(), x, force, 1.0), plan(world, c, x, force, 1.0)
    rod = P_A * (c["area_1"] - c["area_2"])
    assert np.allclose(found.pressure_1 * c["area_1"] - found.pressure_2 * c["area_2"] - rod, force, atol=1e-3)
    assert found.gas < 0.8 * plain.gas and found.recovered > 0.0
    # what a chamber needs is bought or taken back, and over the cycle it loses as much
    needed = sum(drawn(v, p) for v, p in zip(volumes(c, x), (found.pressure_1, found.pressure_2)))
    assert found.gas + found.recovered == pytest.approx(needed, rel=0.02)
    # the tank gets its gas from a chamber above its own pressure, and gives it to one below
    above = [np.maximum(p - 3e5, 0.0).max() for p in (found.pressure_1, found.pressure_2)]
    assert max(above) > 0.0


def test_a_tank_that_no_chamber_gets_above_is_of_no_use():
    world, c = with_tank(10.9e5)
    x, force = np.full(64, 0.08), 200.0 * np.sin(2 * np.pi * PHASE)
    assert plan(world, c, x, force, 1.0).gas == pytest.approx(plan(paper_world(P_S)[0], cylinder(), x, force, 1.0).gas, rel=1e-6)
