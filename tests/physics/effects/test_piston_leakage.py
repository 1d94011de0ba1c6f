"""Known limits of piston leakage: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.air import PA, K, R
from physics.stepping import hold, tank

from exo_sim.physics import nozzle, plant, state
from exo_sim.physics.conditions import Chamber
from exo_sim.physics.effects import piston_leakage
from exo_sim.physics.pneumatics import Pneumatics, paper_cylinder, paper_world


def test_chambers_meet_at_the_mean_weighted_by_volume() -> None:
    for key, value in (("area", 1e-7), ("laminar", 1e-14)):
        gas = tank(5e-5, 5e-6, dt=1e-3)
        gas.cylinders["dead_volume_2"] = 2e-5
        gas.cylinders["piston_leakage"][key] = value
        gas.fill(np.zeros(1), 6e5, 2e5)
        energy = gas.integrated[0, [state.ENERGY_1, state.ENERGY_2]].sum()
        hold(gas, 0.0, 0.05)
        between = gas.pressures(np.zeros(1))[0]
        assert 6e5 > between[0] > between[1] > 2e5
        hold(gas, 0.0, 8.0)
        v = np.array(plant.volumes(gas.cylinders[0], 0.0))
        assert gas.pressures(np.zeros(1))[0] == pytest.approx((6e5 * v[0] + 2e5 * v[1]) / v.sum(), rel=1e-6)
        assert gas.integrated[0, [state.ENERGY_1, state.ENERGY_2]].sum() == pytest.approx(energy, rel=1e-12)


def test_leaks_to_the_air_where_chamber_2_is_the_air() -> None:
    gas = Pneumatics(paper_world(), paper_cylinder(0.032, 0.012, 0.1, 5e-6, 5e-5, 0.0, single_acting=True), dt=1e-3)
    gas.cylinders["piston_leakage"]["area"] = 1e-7
    gas.fill(np.zeros(1), 6e5, PA)
    hold(gas, 0.0, 5.0)
    assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(PA, rel=1e-4)
    assert gas.books().mass_residual < 1e-12


def test_a_leak_with_a_ratio_of_its_own_is_the_same_both_ways_and_slower_near_equal_pressures() -> None:
    """Of 3 to 2.4 bar an orifice of b = 0.2 passes sqrt(1 - 0.75^2) of what chokes, a nozzle 0.819 (ISO 6358:1989; equation 26)."""
    c, world = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["piston_leakage"][0], paper_world()[0]
    c["area"] = 5e-8
    fuller = Chamber(1, 3e5, 293.15, 1e-4, 293.15, 8e-4, 0.05, 0.0, 0.05, 0.0, 8e-4, 0.1)
    emptier = fuller._replace(side=2, p=2.4e5)
    nozzle_passes = piston_leakage.across(c, fuller, emptier, world)
    choked = nozzle.choked_flow(5e-8, 3e5, 293.15, K, R)
    c["ratio"] = 0.2
    passes = piston_leakage.across(c, fuller, emptier, world)
    assert passes == pytest.approx(choked * math.sqrt(1.0 - 0.75**2), rel=1e-12)
    assert passes == pytest.approx(-piston_leakage.across(c, emptier, fuller, world), rel=1e-12)
    assert nozzle_passes / choked == pytest.approx(0.8188, abs=1e-4)
