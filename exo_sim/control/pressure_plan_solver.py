"""The linear program of `pressure_plan`, solved by interior points along the cycle: compiled, a hundredth of a second and less.

Each interval of a cycle touches only its neighbours, so the normal equations are a cyclic chain of two pressures an interval
(`pressure_plan_normal_equations`); a general solver does not see that. The method is Mehrotra's predictor and corrector (Mehrotra 1992;
Wright, Primal-dual interior-point methods, 1997, chapter 10), started from any point. `tests/control` holds it against HiGHS.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.control.pressure_plan_normal_equations import empty_chain, factored, solved
from exo_sim.physics.compiled import kernel

Array = NDArray[np.float64]
#: Gas [g] and violations of rows [bar, g] below which a solution is found; of gas where rounding stops it earlier.
_NEAR, _NEAR_ENOUGH = 5e-5, 1e-3
#: What a bar over an interval costs [g], so little that it only decides between plans that draw as much: the one of lower pressures.
_LOW = 1e-5
#: By how much prices may contradict each other, of a gram's.
_PRICES_OFF = 1e-2
_MOST_STEPS = 60
#: How much of the way to the nearest bound is gone.
_GONE = 0.995
#: Least slack of a row at the start, and its price.
_SLACK, _PRICE = 0.1, 0.5


class Program(NamedTuple):
    """Pressures [bar], gas [g], and forces in the grams that a missing newton counts for.

    The variables, one after the other: pressures p (n, 2) at the start of each interval; gas that a chamber draws in it, and takes from the
    tank or gives to it (n, 2, 2); force missing or in excess (n,); the spring's force at X = 0 and its stiffness (2,).

    Attributes:
        rows: What each chamber's rows count, at most `most`: its pressure in this interval, in the next, its two gases, (n, 2, m, 4).
        most: (n, 2, m).
        cost: Of the two gases of each chamber, (n, 2, 2).
        sign: What a gram that a chamber exchanges counts in the balance of the tank: 1 taken, -1 given, 0 where there is none, (n, 2).
        force: What both pressures and the spring count in the force of an interval, (n, 4).
        wanted: That force, (n,).
        spring: What a spring's two numbers count in its four bounds, (4, 2).
        spring_most: The bounds; the third, the largest stiffness, is 0 where there is no spring to choose, (4,).
    """

    rows: Array
    most: Array
    cost: Array
    sign: Array
    force: Array
    wanted: Array
    spring: Array
    spring_most: Array


class Solution(NamedTuple):
    """What solves a program.

    Attributes:
        pressure: (n, 2) [bar].
        gas: (n, 2, 2) [g].
        missing: (n,), in the grams that it counts for.
        spring: (2,).
        found: Whether it does.
    """

    pressure: Array
    gas: Array
    missing: Array
    spring: Array
    found: bool


def solve(program: Program) -> Solution:
    """Return the solution of a program; it has one, since force may be missing."""
    n, x = len(program.wanted), _first(program)
    found = bool(_interior(program, x))
    return Solution(x[: 2 * n].reshape(n, 2), x[2 * n : 6 * n].reshape(n, 2, 2), x[6 * n : 7 * n], x[7 * n :], found)


def _first(program: Program) -> Array:
    """Return a guess: pressures half way between their bounds, the last two rows of a chamber."""
    n = len(program.wanted)
    pressure = 0.5 * (program.most[:, :, -1] - program.most[:, :, -2])
    spring = np.array([0.0, 0.5 * program.spring_most[2]])
    given = np.sum(np.concatenate([pressure, np.broadcast_to(spring, (n, 2))], axis=1) * program.force, axis=1)
    return np.concatenate([pressure.ravel(), np.tile([0.1, 0.05], 2 * n), np.abs(given - program.wanted) + _SLACK, spring])


@kernel
def _times(program, x, out):
    """Write what the rows count at x: chambers' (n, 2, m), forces' (n, 2), the tank's, the spring's (4,)."""
    n, m = program.rows.shape[0], program.rows.shape[2]
    p, gas, missing, spring = x[: 2 * n], x[2 * n : 6 * n], x[6 * n : 7 * n], x[7 * n :]
    balance = 0.0
    for j in range(n):
        for k in range(2):
            at = 2 * j + k
            now, then, drawn, tank = p[at], p[(at + 2) % (2 * n)], gas[2 * at], gas[2 * at + 1]
            balance += program.sign[j, k] * tank
            for i in range(m):
                a = program.rows[j, k, i]
                out[at * m + i] = a[0] * now + a[1] * then + a[2] * drawn + a[3] * tank
        f = program.force[j]
        force = f[0] * p[2 * j] + f[1] * p[2 * j + 1] + f[2] * spring[0] + f[3] * spring[1]
        out[2 * n * m + 2 * j], out[2 * n * m + 2 * j + 1] = force - missing[j], -force - missing[j]
    out[2 * n * (m + 1)] = balance
    for i in range(4):
        out[2 * n * (m + 1) + 1 + i] = program.spring[i, 0] * spring[0] + program.spring[i, 1] * spring[1]


@kernel
def _less_transposed(program, v, out):
    """Take from out what numbers by row count by variable."""
    n, m = program.rows.shape[0], program.rows.shape[2]
    balance = v[2 * n * (m + 1)]
    for j in range(n):
        for k in range(2):
            at = 2 * j + k
            now, then, drawn, tank = 0.0, 0.0, 0.0, program.sign[j, k] * balance
            for i in range(m):
                a, each = program.rows[j, k, i], v[at * m + i]
                now += a[0] * each
                then += a[1] * each
                drawn += a[2] * each
                tank += a[3] * each
            out[at] -= now
            out[(at + 2) % (2 * n)] -= then
            out[2 * n + 2 * at] -= drawn
            out[2 * n + 2 * at + 1] -= tank
        f, more, less = program.force[j], v[2 * n * m + 2 * j], v[2 * n * m + 2 * j + 1]
        out[2 * j] -= f[0] * (more - less)
        out[2 * j + 1] -= f[1] * (more - less)
        out[7 * n] -= f[2] * (more - less)
        out[7 * n + 1] -= f[3] * (more - less)
        out[6 * n + j] += more + less
    for i in range(4):
        for k in range(2):
            out[7 * n + k] -= program.spring[i, k] * v[2 * n * (m + 1) + 1 + i]


@kernel
def _right_sides(program):
    """Return what the rows are at most, in the order of `_times`."""
    n, m = program.rows.shape[0], program.rows.shape[2]
    out = np.empty(2 * n * (m + 1) + 5)
    out[: 2 * n * m] = program.most.ravel()
    out[2 * n * m : 2 * n * (m + 1) : 2] = program.wanted
    out[2 * n * m + 1 : 2 * n * (m + 1) : 2] = -program.wanted
    # a machine without tank or spring has rows of zeros for them
    out[2 * n * (m + 1)] = 0.0 if np.abs(program.sign).max() > 0.0 else 1.0
    out[2 * n * (m + 1) + 1 :] = program.spring_most
    if program.spring_most[2] <= 0.0:
        out[2 * n * (m + 1) + 1 :] = 1.0
    return out


@kernel
def _furthest(values, change):
    """Return how far, at most 1, positive values may go along a change and stay so."""
    most = 1.0
    for i in range(len(values)):
        if change[i] < 0.0:
            most = min(most, -values[i] / change[i])
    return most


@kernel
def _downhill(program, held, price, out):
    """Write by variable what cost and prices of rows leave: nothing where the prices are those of a solution."""
    n = program.rows.shape[0]
    out[: 2 * n] = -_LOW
    out[2 * n : 6 * n] = -program.cost.ravel()
    out[6 * n : 7 * n] = -1.0
    out[7 * n :] = 0.0
    _less_transposed(program, price, out)
    if held:
        out[7 * n :] = 0.0


@kernel
def _interior(program, x):
    """Go from any point x to the solution, in place; return whether it was reached."""
    n, right, held = program.rows.shape[0], _right_sides(program), program.spring_most[2] <= 0.0
    count = len(right)
    slack, price, change, priced, counted = np.empty(count), np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    beyond, left = np.empty(count), np.empty(count)
    step, down, near, chain = np.empty(len(x)), np.empty(len(x)), x.copy(), empty_chain(n)
    _times(program, x, counted)
    for i in range(count):
        slack[i], price[i] = max(right[i] - counted[i], _SLACK), _PRICE
    found = False
    for _ in range(_MOST_STEPS):
        _times(program, x, counted)
        beyond[:] = counted + slack - right
        _downhill(program, held, price, down)
        gap, off, prices_off = np.dot(slack, price), np.abs(beyond).max(), np.abs(down).max()
        if found and not prices_off < _PRICES_OFF:
            break  # rounding has the last word: the step before was near enough
        if gap < _NEAR_ENOUGH and off < _NEAR and prices_off < _PRICES_OFF:
            near[:], found = x, True
            if gap < _NEAR:
                break
        factored(program, price / slack, held, chain)
        aim = 0.0
        for corrected in range(2):
            for i in range(count):
                left[i] = slack[i] * price[i]
                if corrected == 1:
                    left[i] += change[i] * priced[i] - aim
                counted[i] = price[i] + (price[i] * beyond[i] - left[i]) / slack[i]
            _downhill(program, held, counted, down)
            solved(program, chain, down, step)
            _times(program, step, counted)
            for i in range(count):
                change[i] = -beyond[i] - counted[i]
                priced[i] = -(left[i] + price[i] * change[i]) / slack[i]
            by_x, by_price = _furthest(slack, change), _furthest(price, priced)
            if corrected == 0:
                aim = np.dot(slack + by_x * change, price + by_price * priced) ** 3 / gap**2 / count
        if not np.isfinite(np.sum(step)):
            break
        by_x, by_price = min(1.0, _GONE * by_x), min(1.0, _GONE * by_price)
        x += by_x * step
        slack += by_x * change
        price += by_price * priced
    x[:] = near
    return found
