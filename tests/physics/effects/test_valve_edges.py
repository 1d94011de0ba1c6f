"""Known limits of valve edges: closed forms and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from physics.air import PA, K
from physics.stepping import hold, tank

from exo_sim.physics import nodes, nozzle
from exo_sim.physics.declaration import declared
from exo_sim.physics.effects.valve_edges import EDGES
from exo_sim.physics.pneumatics import Pneumatics


def edges(volume: float = 5e-5, area: float = 5e-6, dt: float = 1e-3, **numbers: float) -> Pneumatics:
    """Return two chambers on a valve whose edges differ so, filled to 3 bar."""
    gas = tank(volume, area, dt=dt)
    for name, value in numbers.items():
        gas.cylinders["valve_edges"][name] = value
    gas.fill(np.zeros(1), 3e5, 3e5)
    return gas


def test_equal_overlaps_are_the_dead_band_to_the_last_bit() -> None:
    lapped, banded = edges(**{f"overlap_{edge}": 0.07 for edge in EDGES}), edges()
    banded.cylinders["valve_deadband"]["width"] = 0.07
    for command in (0.05, 0.1, -0.3, 0.0, 1.0, -0.071):
        for gas in (lapped, banded):
            hold(gas, command, 0.02)
        assert (lapped.pressures(np.zeros(1)) == banded.pressures(np.zeros(1))).all()
        assert (lapped.temperatures() == banded.temperatures()).all()
    assert lapped.books().mass_residual < 1e-12


def test_overlaps_come_on_top_of_the_dead_band() -> None:
    both, lapped = edges(overlap_supply_1=0.02, overlap_exhaust_2=-0.03), edges(**{f"overlap_{edge}": 0.05 for edge in EDGES})
    both.cylinders["valve_deadband"]["width"] = 0.05
    lapped.cylinders["valve_edges"]["overlap_supply_1"], lapped.cylinders["valve_edges"]["overlap_exhaust_2"] = 0.07, 0.02
    for command in (0.03, 0.06, 0.5, -0.06):
        for gas in (both, lapped):
            hold(gas, command, 0.02)
        assert both.pressures(np.zeros(1)) == pytest.approx(lapped.pressures(np.zeros(1)), rel=1e-12)


def test_every_edge_opens_where_its_overlap_ends() -> None:
    overlaps = (0.1, 0.2, 0.3, -0.25)
    gas = edges(**{f"overlap_{edge}": overlap for edge, overlap in zip(EDGES, overlaps, strict=True)})
    for command in np.linspace(-1.0, 1.0, 81):
        found = nodes.path_areas(gas.cylinders[0], command, -command)
        for area, overlap, towards in zip(found, overlaps, (1.0, -1.0, -1.0, 1.0), strict=True):
            opening = (towards * command - overlap) / (1.0 - overlap)
            assert area == pytest.approx(5e-6 * min(max(opening, 0.0), 1.0), abs=1e-20)
    hold(gas, 0.15, 0.02)  # the supply's edge of chamber 1 is open, and the exhaust's of chamber 2, which no command below -0.25 shuts
    first = gas.pressures(np.zeros(1))[0].copy()
    assert first[0] > 3e5 > first[1]
    hold(gas, -0.15, 0.02)  # only that exhaust's
    second = gas.pressures(np.zeros(1))[0]
    assert second[0] == first[0] and second[1] < first[1]


def test_open_centre_is_two_orifices_in_series() -> None:
    """A.4.6: areas in over areas out of 0.5, 1 and 2 between 7 bar and the atmosphere."""
    lapped = {f"overlap_{edge}": -0.1 for edge in EDGES}
    for ratio, pressure in ((0.5, 350000.0), (1.0, 565220.830689), (2.0, 661091.836534)):
        gas = edges(2e-5, 3e-5, excess_supply_1=ratio - 1.0, excess_exhaust_2=1.0 / ratio - 1.0, **lapped)
        hold(gas, 0.0, 3.0)
        assert gas.pressures(np.zeros(1))[0] == pytest.approx(pressure, rel=1e-8)
        assert gas.books().mass_residual < 1e-10


def test_choked_fills_and_vents_go_with_the_areas() -> None:
    excess = (0.4, -0.35, -0.2, 0.1)
    gas = edges(1.0, dt=1e-4, **{f"excess_{edge}": more for edge, more in zip(EDGES, excess, strict=True)})
    for command, (one, two) in ((1.0, (0, 3)), (-1.0, (1, 2))):
        before = gas.integrated[0, [0, 2]].copy()
        p, t = gas.pressures(np.zeros(1))[0], gas.temperatures()[0]
        hold(gas, command, 1e-3)
        for side, edge in ((0, one), (1, two)):
            fills = edge in (0, 2)
            up, warm, down = (7e5, 293.15, p[side]) if fills else (p[side], t[side], PA)
            flow = nozzle.mass_flow(5e-6 * (1.0 + excess[edge]), up, warm, down, K, 287.05)
            moved = gas.integrated[0, 2 * side] - before[side]
            assert moved == pytest.approx((1.0 if fills else -1.0) * flow * 1e-3, rel=1e-4)


@pytest.mark.parametrize("chamber", [1, 2])
def test_an_exhaust_edge_with_underlap_is_a_leak_to_the_surroundings_while_the_valve_is_shut(chamber: int) -> None:
    """Only while the valve works do they differ: what is found of one is held against the other."""
    underlap, area = 0.01, 5e-6
    under, leaking = edges(area=area, **{f"overlap_exhaust_{chamber}": -underlap}), edges(area=area)
    leaking.cylinders["external_leakage"][f"area_{chamber}"] = area * underlap / (1.0 + underlap)
    for gas in (under, leaking):
        hold(gas, 0.0, 0.5)
    np.testing.assert_allclose(under.pressures(np.zeros(1)), leaking.pressures(np.zeros(1)), rtol=1e-9)
    assert leaking.pressures(np.zeros(1))[0, chamber - 1] < 2.9e5
    assert "valve_edges" in declared()["external_leakage"].mistaken_for
    for gas in (under, leaking):
        hold(gas, 0.5 if chamber == 1 else -0.5, 0.01)
    assert abs(np.diff([gas.pressures(np.zeros(1))[0, chamber - 1] for gas in (under, leaking)])[0]) > 10.0
