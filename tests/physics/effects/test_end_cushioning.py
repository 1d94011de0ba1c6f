"""Known limits of end cushioning: closed forms and published numbers."""

from __future__ import annotations

from collections import namedtuple

import numpy as np
import pytest
from physics.air import PA, K, R
from physics.stepping import bench, drive, hold
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


@pytest.mark.parametrize("places", [(0.0300, 0.0060), (0.0293, 0.0053), (0.0287, 0.0047), (0.06, 0.096)])
def test_a_long_step_that_meets_the_seal_is_as_good_as_short_ones(places: tuple[float, float]) -> None:
    """Where the seal closes the path's area jumps: a step across it would be off by some of what it lets pass too much."""
    found = []
    for dt in (4e-3, 2e-5):
        gas = bench(dt=dt, p_1=5e5, p_2=3e5, x=places[0], dead=5e-6)
        gas.cylinders["end_cushioning"]["length"], gas.cylinders["end_cushioning"]["area"] = 0.0117, 2e-7
        gas.fill(np.array([places[0]]), 5e5, 3e5)
        path = np.linspace(*places, round(0.04 / dt) + 1)
        found.append(drive(gas, path, -1.0 if places[1] < places[0] else 1.0)[-1, :2])
    np.testing.assert_allclose(found[0], found[1], rtol=2e-3)


@pytest.mark.parametrize(
    ("x", "end", "share"),
    [(0.03, 0.0, 2 / 3), (0.0, 0.03, 1 / 3), (0.07, 0.1, 2 / 3), (0.005, 0.095, 5 / 90), (0.03, 0.05, 1.0), (0.01, 0.0, 1.0)],
)  # fmt: skip
def test_the_next_seal_on_a_way(x: float, end: float, share: float) -> None:
    assert end_cushioning.reached(_Cushion(0.01, 2e-7), x, end, 0.1) == pytest.approx(share, abs=1e-6)
