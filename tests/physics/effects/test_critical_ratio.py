"""Known limits of critical ratio: closed forms and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.air import PA, K
from physics.stepping import hold, tank

from exo_sim.physics.effects import critical_ratio
from exo_sim.physics.pneumatics import paper_cylinder


def test_charging_by_the_iso_ellipse() -> None:
    """A.4.5: C = 1e-8 m^3/(s Pa), b = 0.3, one litre from the atmosphere to 7 bar."""
    gas = tank(1e-3, 5.020208972e-6, dt=1e-4)
    gas.cylinders["critical_ratio"]["ratio"] = 0.3
    gas.fill(np.zeros(1), PA, PA)
    for seconds, pressure in ((0.2, 296316.029918), (0.2, 476867.118919)):
        hold(gas, 1.0, seconds)
        assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(pressure, rel=1e-7)


def test_charging_with_an_index_of_one_follows_tanh() -> None:
    """A.4.5 with m = 1 in place of 1/2: beyond b, d(p/P0)/dt = (1 - y^2)/tau_f with y = (p/P0 - b)/(1 - b), so y = tanh."""
    gas = tank(1e-3, 5.020208972e-6, dt=1e-4)
    gas.cylinders["critical_ratio"]["ratio"], gas.cylinders["critical_ratio"]["index"] = 0.3, 1.0
    gas.fill(np.zeros(1), PA, PA)
    tau, choked = 0.716318494460, 0.111208446265
    for t in (0.2, 0.4, 0.6):
        hold(gas, 1.0, 0.2)
        y = math.tanh((t - choked) / (tau * 0.7))
        assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(7e5 * (0.3 + 0.7 * y), rel=1e-7)


def test_an_index_of_a_half_is_the_ellipse() -> None:
    law = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["critical_ratio"].copy()
    law["ratio"] = 0.3
    for down in np.linspace(1e5, 7e5, 61):
        law["index"] = 0.0
        plain = critical_ratio.flow(law[0], 5e-6, 7e5, 293.15, down, 293.15, K, 287.05)
        law["index"] = 0.5
        assert critical_ratio.flow(law[0], 5e-6, 7e5, 293.15, down, 293.15, K, 287.05) == plain
        law["index"] = 0.5 + 1e-12
        assert critical_ratio.flow(law[0], 5e-6, 7e5, 293.15, down, 293.15, K, 287.05) == pytest.approx(plain, rel=1e-9, abs=1e-18)


def test_a_cracking_pressure_stays_between_supply_and_chamber() -> None:
    for index in (0.0, 0.6):
        gas = tank(1e-5, 5e-6, dt=1e-3)
        for name, value in (("ratio", 0.35), ("index", index), ("cracking", 4e4)):
            gas.cylinders["critical_ratio"][name] = value
        gas.fill(np.zeros(1), PA, 5e5)
        hold(gas, 1.0, 1.0)
        assert gas.pressures(np.zeros(1))[0] == pytest.approx([7e5 - 4e4, PA + 4e4], abs=20.0)
        assert gas.books().mass_residual < 1e-10 and gas.books().energy_residual < 1e-10


def test_choked_flow_knows_neither_index_nor_cracking() -> None:
    law = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["critical_ratio"].copy()
    law["ratio"], law["index"], law["cracking"] = 0.25, 0.6, 3e4
    assert critical_ratio.flow(law[0], 5e-6, 7e5, 293.15, 1.7e5, 293.15, K, 287.05) == pytest.approx(8.261608278286e-3, rel=1e-10)
