"""Known limits of transmission compliance: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.air import PA
from physics.stepping import bench, drive


def test_gas_and_mount_are_springs_in_series() -> None:
    ends = []
    for step in (-1e-5, 1e-5):
        gas = bench()
        gas.cylinders["transmission_compliance"]["stiffness"] = 1e5
        gas.fill(np.array([0.05]), 5e5, 565237.727273)
        ends.append(drive(gas, np.linspace(0.05, 0.05 + step, 11))[-1, 4])
    assert (ends[0] - ends[1]) / 2e-5 == pytest.approx(1 / (1 / 22198.067690 + 1 / 1e5), rel=1e-4)


def test_drag_on_the_piston_comes_through_the_mount() -> None:
    forces = []
    for stiffness in (0.0, 1e7):
        gas = bench(dead=1e-2)
        gas.cylinders["transmission_compliance"]["stiffness"] = stiffness
        gas.cylinders["viscous_friction"]["coefficient"] = 200.0
        gas.cylinders["return_spring"]["stiffness"] = 500.0
        gas.fill(np.array([0.05]), PA, PA)
        forces.append(drive(gas, 0.05 + 0.1 * 1e-3 * np.arange(200, dtype=float))[-1, 4])
    assert forces[0] == pytest.approx(-20.0 - 500.0 * 0.0699, rel=0.01)
    assert forces[1] == pytest.approx(forces[0], rel=5e-3)
