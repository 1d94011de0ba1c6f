"""Known limits of pressure dependent friction: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.air import PA
from physics.stepping import bench, drive

from exo_sim.physics.conditions import Motion
from exo_sim.physics.friction import dry_level
from exo_sim.physics.pneumatics import paper_cylinder


def test_level_is_the_area_times_both_gauge_pressures() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    c["pressure_dependent_friction"]["coefficient"] = 2e-5
    assert dry_level(c[0], Motion(0.0, 0.1, 0.0, 4e5, 1e5)) == pytest.approx(10.0)
    assert dry_level(c[0], Motion(0.0, 0.1, 0.0, -5e4, 1e5)) == pytest.approx(2.0)
    gas = bench(dead=1.0)
    gas.cylinders["pressure_dependent_friction"]["coefficient"] = 2e-5
    gas.fill(np.array([0.05]), 5e5, 2e5)
    path = 0.05 + 0.01 * np.concatenate([np.linspace(0, 1, 100), np.linspace(1, 0, 100)])
    force = drive(gas, path)[:, 4]
    assert force[150] - force[50] == pytest.approx(2 * 2e-5 * (7e5 - 2 * PA), rel=1e-3)


def test_difference_of_pressures_has_an_area_of_its_own() -> None:
    c = paper_cylinder(0.032, 0.012, 0.1, 5e-6)
    c["pressure_dependent_friction"]["difference"] = 3e-5
    for one, two in ((4e5, 1e5), (1e5, 4e5), (-5e4, 2.5e5)):
        assert dry_level(c[0], Motion(0.0, 0.1, 0.0, one, two)) == pytest.approx(9.0)
    c["pressure_dependent_friction"]["coefficient"] = 2e-5
    assert dry_level(c[0], Motion(0.0, -0.1, 0.0, 4e5, 1e5)) == pytest.approx(10.0 + 9.0)
