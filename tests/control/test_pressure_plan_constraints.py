"""The lines that bound what a path lets through lie on or above the flow itself."""

import numpy as np
import pytest

from exo_sim.control.pressure_plan_constraints import FLOW_SHARE, GRAM, ChamberRows
from exo_sim.physics.nozzle import flow
from exo_sim.physics.pneumatics import paper_cylinder, paper_world

N, PERIOD, P_S, P_T, AREA, K, R, T = 16, 1.0, 9e5, 3e5, 10e-6, 1.4, 287.05, 293.15


@pytest.fixture(scope="module")
def chambers():
    world, c = paper_world(P_S), paper_cylinder(0.050, 0.020, 0.1, AREA, 1e-5, 1e-5)
    world["tank_volume"], world["tank_pressure"], c["tank_area"], c["independent"] = 2e-3, P_T, AREA, 1.0
    return ChamberRows(world[0], c[0], np.full(N, 0.05), PERIOD)


def most(rows, right, pressure, gas):
    """The largest gas (2: drawn, 3: exchanged with the tank) that the rows of a chamber allow in an interval at a pressure [bar]."""
    slope = rows[:, gas]
    rest = right - pressure * (rows[:, 0] + rows[:, 1])
    bounding = (slope > 0.0) & (np.arange(len(rows)) > 0)
    return float(np.min(rest[bounding] / slope[bounding]))


def through(p_up, p_down):
    return FLOW_SHARE * PERIOD / N * flow(AREA, p_up, T, p_down, T, K, R) / GRAM


@pytest.mark.parametrize("p", [1.2e5, 2e5, 2.7e5, 2.95e5])
def test_what_the_tank_gives_a_chamber_is_bounded_by_its_path(chambers, p):
    rows, right = chambers.rows(np.ones((N, 2), bool))
    found = most(rows[0, 0], right[0, 0], p / 1e5, 3)
    assert through(P_T, p) <= found * (1.0 + 1e-9) and found < 1.25 * through(P_T, p) + 0.02


@pytest.mark.parametrize("p", [3.1e5, 4e5, 8e5])
def test_what_a_chamber_gives_the_tank_is_bounded_by_its_path(chambers, p):
    rows, right = chambers.rows(np.zeros((N, 2), bool))
    found = most(rows[0, 1], right[0, 1], p / 1e5, 3)
    assert through(p, P_T) <= found * (1.0 + 1e-9) and found < 1.25 * through(p, P_T) + 0.02


def test_a_chamber_said_to_be_below_the_tank_may_not_take_above_it(chambers):
    rows, right = chambers.rows(np.ones((N, 2), bool))
    assert most(rows[0, 0], right[0, 0], 1.05 * P_T / 1e5, 3) < 0.0


def test_what_is_drawn_is_bounded_by_the_supplys_path(chambers):
    rows, right = chambers.rows()
    for p in (2e5, 6e5, 8.5e5):
        found = most(rows[0, 0], right[0, 0], p / 1e5, 2)
        assert through(P_S, p) <= found * (1.0 + 1e-9) and found < 1.25 * through(P_S, p) + 0.02


def test_an_idle_chamber_is_kept_at_the_exhausts_pressure(chambers):
    other = ChamberRows(paper_world(P_S)[0], paper_cylinder(0.050, 0.020, 0.1, AREA, 1e-5, 1e-5)[0], np.full(N, 0.05), PERIOD)
    other.keep_idle(np.array([3]), np.array([1]))
    _, right = other.rows()
    assert right[3, 1, -1] == pytest.approx(other.floor, abs=1e-3) and right[2, 1, -1] > 5.0
