"""Volumes, pressures and temperatures from the state, and the areas of the four paths."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import bench

from exo_sim.physics import nodes, state
from exo_sim.physics.effects import line_restriction
from exo_sim.physics.pneumatics import paper_cylinder, paper_world


def test_beyond_the_ends_a_chamber_keeps_half_its_dead_volume_or_the_smallest() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 4e-6, 0.0)[0]
    assert nodes.volumes(c, -0.01)[0] == 2e-6 and nodes.volumes(c, 0.11)[1] == nodes.SMALLEST
    low, high = nodes.within(c, -1.0), nodes.within(c, 1.0)
    assert nodes.volumes(c, low)[0] == pytest.approx(2e-6) and nodes.volumes(c, high)[1] == pytest.approx(nodes.SMALLEST)
    assert nodes.within(c, 0.05) == 0.05


def test_pressure_and_temperature_are_those_it_was_filled_with() -> None:
    gas = bench(p_1=5e5, p_2=2e5)
    one, two = nodes.chambers(gas.world[0], gas.cylinders[0], gas.vector, 0, 0.05, 0.3)
    assert (one.p, two.p) == pytest.approx((5e5, 2e5)) and (one.t, two.t) == pytest.approx((293.15, 293.15))
    assert (one.side, two.side, one.speed, two.speed) == (1, 2, 0.3, -0.3)
    assert one.depth + two.depth == pytest.approx(0.1)
    assert nodes.temperatures(gas.world[0], gas.vector, 0) == pytest.approx((293.15, 293.15))


def test_chamber_two_of_a_single_acting_cylinder_is_the_atmosphere() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6, 4e-6, 0.0, single_acting=True)[0]
    y = np.zeros(state.size(1, 0))
    y[state.ENERGY_1] = 6e5 * nodes.volumes(c, 0.05)[0] / 0.4
    assert nodes.pressures(paper_world()[0], c, y, 0, 0.05) == pytest.approx((6e5, 101325.0))


def test_supply_and_exhaust_are_the_rigs_constants_without_a_tank_or_manifold() -> None:
    world, y = paper_world(), np.zeros(state.size(1, 0))
    assert nodes.supply_state(world[0], y, state.INTEGRATED, 0.0) == (7e5, 293.15)
    assert nodes.exhaust_state(world[0], y, state.INTEGRATED)[0] == 101325.0
    world["supply_regulator"]["droop"] = 2e7
    assert nodes.supply_state(world[0], y, state.INTEGRATED, 1e-3)[0] == pytest.approx(7e5 - 2e4)


def test_a_vented_cylinder_has_both_exhausts_open() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    assert nodes.path_areas(c[0], 0.5, -0.5) == pytest.approx((2.5e-6, 0.0, 0.0, 2.5e-6))
    c["vented"] = 1.0
    assert nodes.path_areas(c[0], 0.5, -0.5) == (0.0, 5e-6, 0.0, 5e-6)


@pytest.mark.parametrize("length", [0.0, 2.0], ids=["one node", "a long hose"])
def test_a_hose_is_given_another_pressure_throughout_at_its_temperature(length: float) -> None:
    gas = bench()
    gas.cylinders["line_restriction"]["area"], gas.cylinders["line_restriction"]["volume"] = 5e-6, 4e-5
    gas.cylinders["line_restriction"]["length"] = length
    gas.fill(np.array([0.05]), 5e5, 4e5)
    before, k = gas.integrated[0].copy(), float(gas.world["k"][0])
    nodes.change_hose_pressure(gas.cylinders[0], gas.vector, 0, 1, 1e5, k)
    after = gas.integrated[0]
    places = [state.HOSE_MASS_2] + ([state.MIDDLE_MASS_2] if length else [])
    for place in places:
        assert after[place : place + 2] == pytest.approx(1.25 * before[place : place + 2], rel=1e-12)
    others = np.setdiff1d(np.arange(state.INTEGRATED), [i for place in places for i in (place, place + 1)])
    assert (after[others] == before[others]).all()
    nodes.change_hose_pressure(gas.cylinders[0], gas.vector, 0, 1, -1e9, k)
    volume = line_restriction.node_volume(gas.cylinders[0]["line_restriction"])
    assert (k - 1.0) * after[state.HOSE_ENERGY_2] / volume == pytest.approx(nodes.LOWEST)
