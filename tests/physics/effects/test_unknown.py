"""Known limits of unknown: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.air import CP
from physics.stepping import hold, tank

from exo_sim.physics import state
from exo_sim.physics.conditions import Motion
from exo_sim.physics.effects import unknown
from exo_sim.physics.friction import sharp_level
from exo_sim.physics.pneumatics import paper_cylinder


def test_curve_is_straight_between_its_knots_and_flat_beyond() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)["unknown"]
    c["at"] = [0.0, 0.1, 0.3] + [0.3] * 13
    c["values"] = [1.0, 3.0, -1.0] + [-1.0] * 13
    for where, value in ((-1.0, 1.0), (0.0, 1.0), (0.05, 2.0), (0.1, 3.0), (0.2, 1.0), (0.3, -1.0), (9.0, -1.0)):
        assert unknown.acting(c[0], 0, where, 5.0, 0.0, 0.0) == pytest.approx(value)
    c["depends_on"] = 4.0
    assert unknown.acting(c[0], 0, 9.0, 9.0, 5.05, 5.0) == pytest.approx(2.0)
    assert unknown.acting(c[0], 1, 9.0, 9.0, 5.05, 5.0) == 0.0


def test_a_curve_of_friction_is_added_to_the_level_of_dry_friction_and_pushes_nothing() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    c["coulomb_friction"]["force"] = 10.0
    c["unknown"]["acts"], c["unknown"]["depends_on"] = unknown.FRICTION, 0.0
    c["unknown"]["at"] = [0.0, 0.1] + [0.1] * 14
    c["unknown"]["values"] = [-4.0, 6.0] + [6.0] * 14
    for where, value in ((0.0, 6.0), (0.05, 11.0), (0.2, 16.0)):
        for speed in (-0.1, 0.1):
            assert sharp_level(c[0], Motion(where, speed, 0.0, 0.0, 0.0)) == pytest.approx(value)
    assert unknown.acting(c["unknown"][0], 0, 0.05, 0.1, 0.0, 0.0) == 0.0


def test_flow_into_a_closed_chamber_is_an_entry_of_the_books() -> None:
    gas = tank(1e-4, 5e-6, dt=1e-3)
    c = gas.cylinders["unknown"]
    c["acts"], c["at"], c["values"] = 2.0, [0.0] + [1.0] * 15, 1e-5
    gas.fill(np.zeros(1), 3e5, 3e5, temperature=320.0)
    mass, energy = gas.integrated[0, [state.MASS_2, state.ENERGY_2]]
    hold(gas, 0.0, 2.0)
    assert gas.integrated[0, state.MASS_2] == pytest.approx(mass + 2e-5, rel=1e-12)
    assert gas.integrated[0, state.ENERGY_2] == pytest.approx(energy + 2e-5 * CP * 293.15, rel=1e-12)
    assert gas.books().mass_residual < 1e-10 and gas.books().energy_residual < 1e-10
