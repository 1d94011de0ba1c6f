"""The interior points against HiGHS (Huangfu and Hall 2018): the same least gas, by a solver that knows nothing of cycles."""

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import linprog

from exo_sim.control.pressure_plan_constraints import ChamberRows
from exo_sim.control.pressure_plan_solver import Program, solve
from exo_sim.physics.pneumatics import paper_cylinder, paper_world

N, P_S, PRICE = 64, 9e5, 0.03
PHASE = 2.0 * np.pi * np.arange(N) / N


def program(below=None, spring=0.0, area=15e-6, short=False):
    """A program of a cylinder that walks; too weak where it is to be short of force."""
    world, c = paper_world(P_S), paper_cylinder(0.050, 0.020, 0.150, area, 1e-5, 1e-5)
    world["tank_volume"], world["tank_pressure"], c["tank_area"], c["independent"] = 2e-3, 2.5e5, area, 1.0
    x = 0.08 + 0.03 * np.cos(PHASE) + 0.01 * np.sin(2.0 * PHASE)
    force = (3.0 if short else 1.0) * (500.0 * np.sin(PHASE + 0.4) + 250.0 * np.cos(2.0 * PHASE))
    rows, most = ChamberRows(world[0], c[0], x, 1.1).rows(below)
    cost = np.ones((N, 2, 2))
    sign = np.zeros((N, 2))
    if below is not None:
        cost[:, :, 1], sign = 0.0, np.where(below, 1.0, -1.0)
    c_1, c_2 = float(c["area_1"][0]) * 1e5, float(c["area_2"][0]) * 1e5
    turned = np.array([[1.0, -0.4], [-1.0, -0.4], [0.0, 1.0], [0.0, -1.0]])
    counts = PRICE * np.stack([np.full(N, c_1), np.full(N, -c_2), np.full(N, -1e3), -1e3 * x], axis=1)
    wanted = PRICE * (force + 101325.0 * (c_1 - c_2) / 1e5)
    return Program(rows, most, cost, sign, counts, wanted, turned, np.array([0.0, 0.0, spring, 0.0]))


def by_highs(of):
    """The least of a program by a general solver: all rows in one matrix."""
    m, n = of.rows.shape[2], 7 * N + 2
    rows, right = [], []
    for j in range(N):
        for k in range(2):
            at = 2 * j + k
            block = np.zeros((m, n))
            for column, i in ((at, 0), ((at + 2) % (2 * N), 1), (2 * N + 2 * at, 2), (2 * N + 2 * at + 1, 3)):
                block[:, column] += of.rows[j, k, :, i]
            rows.append(sparse.csr_matrix(block))
            right.append(of.most[j, k])
        force = np.zeros(n)
        force[[2 * j, 2 * j + 1, 7 * N, 7 * N + 1]] = of.force[j]
        missing = np.zeros(n)
        missing[6 * N + j] = 1.0
        rows.append(sparse.csr_matrix(np.stack([force - missing, -force - missing])))
        right.append(np.array([of.wanted[j], -of.wanted[j]]))
    balance = np.zeros((1, n))
    balance[0, 2 * N + 1 : 6 * N : 2] = of.sign.ravel()
    bounds = np.zeros((4, n))
    bounds[:, 7 * N :] = of.spring
    cost = np.concatenate([np.zeros(2 * N), of.cost.ravel(), np.ones(N), np.zeros(2)])
    found = linprog(
        cost, sparse.vstack([*rows, balance, bounds]), np.concatenate([*right, [0.0], of.spring_most]), bounds=(None, None), method="highs"
    )
    assert found.status == 0
    return found.fun


def least(of):
    found = solve(of)
    assert found.found
    return found, float(np.sum(of.cost * found.gas) + found.missing.sum())


@pytest.mark.parametrize(
    "options",
    [{}, {"area": 3e-6}, {"short": True}, {"spring": 30.0}, {"below": np.stack([np.sin(PHASE) > 0.0, np.sin(PHASE) < 0.2], axis=1)}],
    ids=["plain", "a small valve", "too weak", "a spring", "a tank"],
)
def test_the_least_is_that_of_a_general_solver(options):
    of = program(**options)
    assert least(of)[1] == pytest.approx(by_highs(of), rel=2e-3, abs=2e-3)


def test_every_row_is_kept():
    of = program(np.stack([np.sin(PHASE) > 0.0, np.sin(PHASE) < 0.2], axis=1))
    found, _ = least(of)
    p, gas = found.pressure, found.gas
    counted = np.einsum("nkmi,nki->nkm", of.rows, np.concatenate([p[:, :, None], np.roll(p, -1, axis=0)[:, :, None], gas], axis=2))
    assert np.max(counted - of.most) < 1e-4
    assert np.sum(of.sign * gas[:, :, 1]) < 1e-4
    off = np.abs(np.einsum("nk,nk->n", of.force[:, :2], p) - of.wanted)
    assert np.max(off - found.missing) < 1e-4


def test_without_a_spring_to_choose_there_is_none():
    assert np.abs(least(program())[0].spring).max() < 1e-6
