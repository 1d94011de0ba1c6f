"""The chain against a dense solver, for weights like those far from a solution and near it."""

import numpy as np
import pytest

from exo_sim.control.pressure_plan_normal_equations import empty_chain, factored, solved
from exo_sim.control.pressure_plan_solver import Program

N, M = 6, 5


@pytest.fixture(scope="module")
def program():
    chance = np.random.default_rng(1)
    rows = chance.normal(size=(N, 2, M, 4))
    rows[:, :, 1:3, 3], rows[:, :, 3:, 2] = 0.0, 0.0  # the first row alone has both gases
    force = np.stack([np.full(N, 6.0), np.full(N, -5.0), *chance.normal(size=(2, N))], axis=1)
    sign = np.where(chance.random((N, 2)) < 0.5, 1.0, -1.0)
    bounds = np.array([[1.0, -0.4], [-1.0, -0.4], [0.0, 1.0], [0.0, -1.0]])
    return Program(rows, np.ones((N, 2, M)), np.ones((N, 2, 2)), sign, force, np.ones(N), bounds, np.array([0.0, 0.0, 30.0, 0.0]))


def dense(of):
    """All rows in one matrix: chambers', forces', the tank's, the spring's."""
    out = []
    for j in range(N):
        for k in range(2):
            at = 2 * j + k
            block = np.zeros((M, 7 * N + 2))
            for column, i in ((at, 0), ((at + 2) % (2 * N), 1), (2 * N + 2 * at, 2), (2 * N + 2 * at + 1, 3)):
                block[:, column] += of.rows[j, k, :, i]
            out.append(block)
    for j in range(N):
        force, missing = np.zeros(7 * N + 2), np.zeros(7 * N + 2)
        force[[2 * j, 2 * j + 1, 7 * N, 7 * N + 1]], missing[6 * N + j] = of.force[j], 1.0
        out.append(np.stack([force - missing, -force - missing]))
    last = np.zeros((5, 7 * N + 2))
    last[0, 2 * N + 1 : 6 * N : 2], last[1:, 7 * N :] = of.sign.ravel(), of.spring
    return np.concatenate([*out, last])


@pytest.mark.parametrize("spread", [0.5, 4.0], ids=["weights alike", "weights that differ by 10^8"])
def test_it_solves_the_normal_equations(program, spread):
    chance = np.random.default_rng(2)
    rows = dense(program)
    weight, right = 10.0 ** chance.uniform(-spread, spread, len(rows)), chance.normal(size=7 * N + 2)
    chain, found = empty_chain(N), np.empty(7 * N + 2)
    factored(program, weight, False, chain)
    solved(program, chain, right.copy(), found)
    matrix = rows.T @ (weight[:, None] * rows)
    assert np.abs(matrix @ found - right).max() < 1e-6 * np.abs(right).max()


def test_a_spring_that_there_is_none_of_stays_away(program):
    weight, right = np.ones(len(dense(program))), np.ones(7 * N + 2)
    chain, found = empty_chain(N), np.empty(7 * N + 2)
    factored(program, weight, True, chain)
    solved(program, chain, right, found)
    assert np.abs(found[7 * N :]).max() < 1e-9
