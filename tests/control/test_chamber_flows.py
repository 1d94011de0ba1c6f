"""The lines that bound what a path lets through lie on or above the flow itself, and the columns have one place each."""

import numpy as np
import pytest
from scipy import sparse

from exo_sim.control.chamber_flows import FLOW_SHARE, GRAM, Columns, draw_rows, tank_rows
from exo_sim.physics.nozzle import flow
from exo_sim.physics.pneumatics import paper_cylinder, paper_world

N, PERIOD, P_S, P_T, AREA, K, R, T = 16, 1.0, 9e5, 3e5, 10e-6, 1.4, 287.05, 293.15


@pytest.fixture(scope="module")
def plant():
    world, c = paper_world(P_S), paper_cylinder(0.050, 0.020, 0.1, AREA, 1e-5, 1e-5)
    world["tank_volume"], world["tank_pressure"], c["tank_area"], c["independent"] = 2e-3, P_T, AREA, 1.0
    return world[0], c[0]


def test_every_variable_has_a_place_of_its_own():
    columns = Columns(N)
    found = np.concatenate([np.arange(columns.count)[columns.of(name)] for name in columns._NAMES])
    assert sorted(found) == list(range(columns.count))
    assert columns.pair("taken") == slice(columns.of("taken_1").start, columns.of("taken_2").stop)
    assert columns.row(spring=sparse.csr_matrix([[1.0, 2.0]])).shape == (1, columns.count)


def most(rows, right, values, name):
    """The largest value of a variable of the first interval that the rows allow where all others are as given."""
    columns = Columns(N)
    at = columns.of(name).start
    slope = np.asarray(rows[:, [at]].todense()).ravel()
    rest = right - rows @ values
    return float(np.min((rest / np.where(slope > 0.0, slope, np.inf))[slope > 0.0]))


@pytest.mark.parametrize("p", [1.2e5, 2e5, 2.7e5, 2.95e5])
def test_what_the_tank_gives_a_chamber_is_bounded_by_its_path(plant, p):
    world, c = plant
    rows, right = tank_rows(world, c, np.ones((2, N), bool), PERIOD)
    values = np.zeros(Columns(N).count)
    values[Columns(N).of("p_1")] = p / 1e5
    through = FLOW_SHARE * PERIOD / N * flow(AREA, P_T, T, p, T, K, R) / GRAM
    found = most(rows[1:], right[1:], values, "taken_1")  # the first row is the balance of the tank
    assert through <= found * (1.0 + 1e-9) and found < 1.25 * through + 0.02


def test_a_chamber_said_to_be_below_the_tank_may_not_take_above_it(plant):
    world, c = plant
    rows, right = tank_rows(world, c, np.ones((2, N), bool), PERIOD)
    values = np.zeros(Columns(N).count)
    values[Columns(N).of("p_1")] = 1.05 * P_T / 1e5
    assert most(rows[1:], right[1:], values, "taken_1") < 0.0


def test_what_is_drawn_is_bounded_by_the_supplys_path(plant):
    world, c = plant
    rows, right = draw_rows(world, c, np.full(N, 0.05), PERIOD)
    for p in (2e5, 6e5, 8.5e5):
        values = np.zeros(Columns(N).count)
        values[Columns(N).of("p_1")] = p / 1e5
        through = FLOW_SHARE * PERIOD / N * flow(AREA, P_S, T, p, T, K, R) / GRAM
        assert through <= most(rows, right, values, "drawn_1") * (1.0 + 1e-9)
