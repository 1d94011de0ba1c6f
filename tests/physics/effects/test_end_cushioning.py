"""Known limits of end cushioning: closed forms and published numbers."""

from __future__ import annotations

from collections import namedtuple

import numpy as np
import pytest
from physics.air import PA, K, R
from physics.stepping import bench, hold
from scipy.optimize import brentq

from exo_sim.physics import nozzle, state
from exo_sim.physics.effects import end_cushioning

_Cushion = namedtuple("_Cushion", "length area")


def test_needle_decides_near_the_end_and_only_outwards() -> None:
    for x, area in ((0.004, 2e-7), (0.03, 5e-6)):
        gas = bench(dt=1e-5, p_1=5e5, p_2=3e5, x=x, dead=5e-6)
        gas.cylinders["end_cushioning"]["length"], gas.cylinders["end_cushioning"]["area"] = 0.01, 2e-7
        gas.fill(np.array([x]), 5e5, 3e5)
        before = gas.integrated[0, state.MASS_1]
        hold(gas, -1.0, 1e-5, x)
        out = (before - gas.integrated[0, state.MASS_1]) / 1e-5
        assert out == pytest.approx(nozzle.mass_flow(area, 5e5, 293.15, PA, K, R), rel=5e-3)
        before = gas.integrated[0, state.MASS_1]
        hold(gas, 1.0, 1e-5, x)
        into = (gas.integrated[0, state.MASS_1] - before) / 1e-5
        assert into == pytest.approx(nozzle.mass_flow(5e-6, 7e5, 293.15, 5e5, K, R), rel=5e-3)


def test_needle_and_valve_are_two_nozzles_behind_each_other() -> None:
    for share in (0.2, 0.5, 1.0, 2.0):
        for p_down, within in ((0.1e5, 0.05), (2e5, 0.05), (4e5, 0.12)):
            found = nozzle.mass_flow(end_cushioning.outlet(_Cushion(0.01, share * 5e-6), 5e-6, 0.004), 5e5, 293.15, p_down, K, R)

            def lacking(middle: float, share: float = share, p_down: float = p_down) -> float:
                into = nozzle.mass_flow(share * 5e-6, 5e5, 293.15, middle, K, R)
                return float(into - nozzle.mass_flow(5e-6, middle, 293.15, p_down, K, R))

            middle = brentq(lacking, p_down, 5e5)
            assert found == pytest.approx(nozzle.mass_flow(share * 5e-6, 5e5, 293.15, middle, K, R), rel=within)


def test_none_throttles_nothing_beyond_the_ends_either() -> None:
    for x in (-5e-4, 0.0, 0.1, 0.1005):
        ends = []
        for leak in (0.0, 1e-16):
            gas = bench(dt=1e-3, p_1=5e5, p_2=5e5, x=x, dead=5e-6)
            gas.cylinders["piston_leakage"]["area"] = leak
            gas.fill(np.array([x]), 5e5, 5e5)
            hold(gas, 1.0 if x > 0.05 else -1.0, 1e-3, x)
            ends.append(gas.integrated[0, [state.MASS_1, state.MASS_2]].copy())
        np.testing.assert_allclose(ends[1], ends[0], rtol=1e-9)
