"""Known limits of a valve's characteristic: closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from physics.stepping import hold, tank

from exo_sim.physics import nodes
from exo_sim.physics.effects import valve_characteristic
from exo_sim.physics.pneumatics import Pneumatics

AREA = 5e-6


def valve(**numbers: float) -> Pneumatics:
    """Return two chambers on a valve with such a characteristic, filled to 3 bar."""
    gas = tank(5e-5, AREA, dt=1e-3)
    for name, value in numbers.items():
        gas.cylinders["valve_characteristic"][name] = value
    gas.fill(np.zeros(1), 3e5, 3e5)
    return gas


@pytest.mark.parametrize("curvature, exponent", [(0.5, 0.0), (-0.4, 2.0), (1.0, 1.5), (0.7, 3.0)])
def test_an_edge_opens_by_its_share_and_power(curvature: float, exponent: float) -> None:
    gas = valve(curvature=curvature, exponent=exponent)
    for place in np.linspace(0.0, 1.0, 21):
        opening = (1.0 - curvature) * place + curvature * place ** (exponent or 2.0)
        for command, (into, out_of) in ((place, (0, 3)), (-place, (2, 1))):
            areas = nodes.path_areas(gas.cylinders[0], command, -command)
            assert (areas[into], areas[out_of]) == pytest.approx((AREA * opening,) * 2, rel=1e-12, abs=1e-20)
            assert sum(areas) == pytest.approx(areas[into] + areas[out_of])


def test_full_command_opens_as_far_and_no_command_not_at_all() -> None:
    straight, bent = valve(), valve(curvature=0.6)
    for command in (1.0, 0.0, -1.0):
        for gas in (straight, bent):
            hold(gas, command, 0.01)
        assert (bent.pressures(np.zeros(1)) == straight.pressures(np.zeros(1))).all()
    for gas in (straight, bent):
        hold(gas, 0.3, 0.003)
    assert (np.abs(bent.pressures(np.zeros(1)) - straight.pressures(np.zeros(1))) > 100.0).all()


def test_it_counts_from_the_end_of_the_dead_band_and_of_each_overlap() -> None:
    gas = valve(curvature=0.5)
    gas.cylinders["valve_deadband"]["width"], gas.cylinders["valve_edges"]["overlap_supply_1"] = 0.1, 0.1
    area = nodes.path_areas(gas.cylinders[0], 0.6, -0.6)
    for found, place in ((area[0], 0.5), (area[3], 0.5 / 0.9)):
        assert found == pytest.approx(AREA * (0.5 * place + 0.5 * place * place))


def test_a_rounded_edge_leaves_half_its_rounding_open_where_a_sharp_one_begins() -> None:
    gas = valve(rounding=0.02)
    assert nodes.path_areas(gas.cylinders[0], 0.0, 0.0) == pytest.approx((AREA * 0.01,) * 4)
    far = nodes.path_areas(gas.cylinders[0], 0.5, -0.5)
    assert far[0] == pytest.approx(AREA * 0.5, rel=1e-3) and 0.0 < far[1] < AREA * 2.1e-4


def test_whether_it_is_there() -> None:
    for numbers, there in (({}, False), ({"exponent": 1.5}, False), ({"rounding": 0.01}, True), ({"curvature": -0.2}, True)):
        assert valve_characteristic.present(valve(**numbers).cylinders[0]["valve_characteristic"]) is there


def test_a_larger_command_never_opens_less() -> None:
    for curvature, exponent in ((-1.0, 2.0), (1.0, 4.0), (-0.5, 3.0)):
        record = valve(curvature=curvature, exponent=exponent).cylinders[0]["valve_characteristic"]
        opened = [valve_characteristic.curved(record, place) for place in np.linspace(-0.2, 1.2, 50)]
        assert all(b >= a - 1e-12 for a, b in zip(opened, opened[1:], strict=False)) and max(opened) == 1.0 and math.isfinite(sum(opened))
