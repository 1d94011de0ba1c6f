"""Known limits of valve null leakage: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.stepping import hold, tank


def test_closed_valve_is_two_orifices_in_series() -> None:
    """A.4.6: area in over area out 1 gives 565220.830689 Pa between 7 bar and the atmosphere."""
    gas = tank(2e-5, 5e-6, dt=1e-3)
    gas.cylinders["valve_null_leakage"]["area"] = 3e-7
    gas.fill(np.zeros(1), 3e5, 2e5)
    hold(gas, 0.0, 8.0)
    assert gas.pressures(np.zeros(1))[0] == pytest.approx(565220.830689, rel=1e-9)
    assert gas.temperatures()[0] == pytest.approx(293.15, rel=1e-6)


def test_series_orifices_of_other_sizes() -> None:
    for ratio, pressure in ((0.5, 350000.0), (2.0, 661091.836534)):
        gas = tank(2e-5, 1e-6 * ratio, dt=1e-3)
        gas.cylinders["external_leakage"]["area_1"] = 1e-6
        gas.fill(np.zeros(1), 3e5, 2e5)
        hold(gas, 1.0, 3.0)
        assert gas.pressures(np.zeros(1))[0, 0] == pytest.approx(pressure, rel=1e-9)
