"""Known limits of backlash: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import bench, drive


def test_joint_is_free_over_the_whole_gap_and_no_more() -> None:
    gas = bench()
    gas.cylinders["backlash"]["gap"] = 1e-3
    gas.fill(np.array([0.05]), 5e5, 565237.727273)
    found = drive(gas, np.concatenate([np.linspace(0.05, 0.0495, 50), np.linspace(0.0495, 0.0505, 100)]))
    assert np.abs(found[:, 4]).max() < 1e-6
    assert found[:, 0] == pytest.approx(5e5, rel=1e-8)
    beyond = drive(gas, np.linspace(0.0505, 0.0510, 50))
    assert beyond[-1, 4] == pytest.approx(-22198.0 * 0.5e-3 / (1 + 22198.0 / 1e6), rel=0.02)
