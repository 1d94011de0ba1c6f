"""Known limits of valve deadband: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import hold, tank

from exo_sim.physics import plant
from exo_sim.physics.pneumatics import paper_cylinder


def test_opening_starts_at_the_width_and_ends_at_one() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)[0]
    c["valve_deadband"]["width"] = 0.1
    for u, opening in ((0.1, 0.0), (-0.1, 0.0), (0.55, 0.5), (-0.55, -0.5), (1.0, 1.0)):
        assert plant.opening(c, u) == pytest.approx(opening, abs=1e-15)
    gas = tank(5e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_deadband"]["width"] = 0.1
    gas.fill(np.zeros(1), 3e5, 3e5)
    hold(gas, 0.0999, 1.0)
    assert gas.pressures(np.zeros(1))[0] == pytest.approx([3e5, 3e5], rel=1e-12)
    hold(gas, 0.11, 0.02)
    assert gas.pressures(np.zeros(1))[0, 0] > 3.01e5
