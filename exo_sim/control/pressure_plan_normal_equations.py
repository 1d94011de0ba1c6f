"""The normal equations of `pressure_plan_solver`: a chain of two pressures an interval, closed to a ring, with a border of five numbers.

What belongs to an interval alone, both chambers' gases and the missing force, is eliminated first; then the chain, from its first interval
to the last but one; the border is what is left: the last interval's pressures, the spring's two numbers, and the price of the tank's gas.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.compiled import kernel

Array = NDArray[np.float64]
_BORDER = 5
#: Places in the border: the spring's numbers, and the tank's price; the last pressures are the first two.
_SPRING, _TANK = 2, 4
#: What keeps gases from being free where no row weighs them, and what holds the numbers of a spring that there is none of.
_LEAST, _HELD = 1e-12, 1e12


class Chain(NamedTuple):
    """A factorised matrix.

    Attributes:
        turn: What each chamber's pressure counts along a line of equal force, and across it, (2, 2). These are the two numbers of
            an interval in the chain: force is all but fixed, and in both pressures' own numbers that would drown what is not.
        within: Inverse of what is left of an interval's own block: first, mixed, second, (n - 1, 3).
        onward: What couples its numbers with those of the next interval, alike, (n - 2, 3).
        border: What couples them with the border, (n - 1, 2, 5).
        bordered: That, multiplied by the inverse.
        corner: Inverse of the border's own block, (5, 5).
        local: Inverse of the block of a chamber's two gases, (n, 2, 3).
        coupling: What couples these with its pressures: now with first, now with second, then with first, then with second, (n, 2, 4).
        force: Sum and difference of the weights of both rows of a force, (n, 2).
    """

    turn: Array
    within: Array
    onward: Array
    border: Array
    bordered: Array
    corner: Array
    local: Array
    coupling: Array
    force: Array


@kernel
def empty_chain(n):
    """Return room for a chain of n intervals."""
    return Chain(
        np.empty((2, 2)), np.empty((n - 1, 3)), np.empty((n - 2, 3)), np.empty((n - 1, 2, _BORDER)), np.empty((n - 1, 2, _BORDER)),
        np.empty((_BORDER, _BORDER)), np.empty((n, 2, 3)), np.empty((n, 2, 4)), np.empty((n, 2)),
    )  # fmt: skip


@kernel
def _product(a, x, y):
    """Return a symmetric matrix of two rows (first, mixed, second) times a vector."""
    return a[0] * x + a[1] * y, a[1] * x + a[2] * y


@kernel
def _without_gases(rows, weight, local, coupling):
    """Eliminate a chamber's two gases in an interval; return what is left on its pressures (now, mixed, then).

    The first row, what its pressures ask for, is the only one with both gases: kept apart, nothing is lost by cancellation.

    Args:
        rows: (m, 4).
        weight: (m,).
        local, coupling: Where to write what `Chain` says of them, (3,) and (4,).
    """
    now, mixed, then = 0.0, 0.0, 0.0
    coupling[:] = 0.0
    drawn, tank = _LEAST, _LEAST
    for i in range(len(weight)):
        a = rows[i]
        by_now, by_then = weight[i] * a[0], weight[i] * a[1]
        now += by_now * a[0]
        mixed += by_now * a[1]
        then += by_then * a[1]
        coupling[0] += by_now * a[2]
        coupling[1] += by_now * a[3]
        coupling[2] += by_then * a[2]
        coupling[3] += by_then * a[3]
        if i > 0:
            drawn += weight[i] * a[2] * a[2]
            tank += weight[i] * a[3] * a[3]
    first, second, both = rows[0, 2], rows[0, 3], weight[0]
    whole = drawn * tank + both * (tank * first * first + drawn * second * second)
    local[0], local[1] = (tank + both * second * second) / whole, -both * first * second / whole
    local[2] = (drawn + both * first * first) / whole
    a_0, b_0 = _product(local, coupling[0], coupling[1])
    a_1, b_1 = _product(local, coupling[2], coupling[3])
    now -= coupling[0] * a_0 + coupling[1] * b_0
    mixed -= coupling[0] * a_1 + coupling[1] * b_1
    then -= coupling[2] * a_1 + coupling[3] * b_1
    return now, mixed, then, b_0, b_1


@kernel
def factored(program, weight, held, chain):
    """Factorise the matrix that rows of some weights make.

    Args:
        program: The program.
        weight: Of its rows, in the order of `pressure_plan_solver`.
        held: Whether there is no spring to choose.
        chain: Where to write.
    """
    n, m = program.rows.shape[0], program.rows.shape[2]
    corner = chain.corner
    chain.within[:], chain.onward[:], chain.border[:], corner[:] = 0.0, 0.0, 0.0, 0.0
    _set_turn(program.force[0], chain.turn)
    for j in range(n):
        for k in range(2):
            at = 2 * j + k
            now, mixed, then, by_now, by_then = _without_gases(
                program.rows[j, k], weight[at * m : (at + 1) * m], chain.local[j, k], chain.coupling[j, k]
            )
            sign = program.sign[j, k]
            corner[_TANK, _TANK] -= sign * sign * chain.local[j, k, 2]
            _add_own(chain, j, k, now, -sign * by_now)
            _add_own(chain, (j + 1) % n, k, then, -sign * by_then)
            _add_onward(chain, j, k, mixed)
        _add_force(program.force[j], weight[2 * n * m + 2 * j], weight[2 * n * m + 2 * j + 1], j, chain)
    corner[_TANK, _TANK] -= 1.0 / weight[2 * n * (m + 1)]
    for i in range(2):
        for k in range(2):
            for row in range(4):
                by = weight[2 * n * (m + 1) + 1 + row]
                corner[_SPRING + i, _SPRING + k] += by * program.spring[row, i] * program.spring[row, k]
        if held:
            corner[_SPRING + i, _SPRING + i] += _HELD
    _eliminate(chain)


@kernel
def _set_turn(f, turn):
    """Write what each chamber's pressure counts along a line of equal force and across it, by what both count in the force."""
    size = np.sqrt(f[0] * f[0] + f[1] * f[1])
    turn[0, 0], turn[0, 1], turn[1, 0], turn[1, 1] = -f[1] / size, f[0] / size, f[0] / size, f[1] / size


@kernel
def _add_own(chain, j, k, value, to_tank):
    """Add what a chamber's pressure of an interval counts by itself, and with the price of the tank's gas."""
    along, across = chain.turn[k, 0], chain.turn[k, 1]
    if j < len(chain.within):
        chain.within[j, 0] += along * value * along
        chain.within[j, 1] += along * value * across
        chain.within[j, 2] += across * value * across
        for i in range(2):
            chain.border[j, i, _TANK] += chain.turn[k, i] * to_tank
    else:
        for i in range(2):
            for b in range(2):
                chain.corner[i, b] += chain.turn[k, i] * value * chain.turn[k, b]
            chain.corner[i, _TANK] += chain.turn[k, i] * to_tank
            chain.corner[_TANK, i] += chain.turn[k, i] * to_tank


@kernel
def _add_onward(chain, j, k, value):
    """Add what couples a chamber's pressure of an interval with that of the next."""
    along, across, m = chain.turn[k, 0], chain.turn[k, 1], len(chain.within)
    if j < m - 1:
        chain.onward[j, 0] += along * value * along
        chain.onward[j, 1] += along * value * across
        chain.onward[j, 2] += across * value * across
    else:  # the last interval but one and the first both touch the last, which is in the border
        for i in range(2):
            for b in range(2):
                chain.border[j if j < m else 0, i, b] += chain.turn[k, i] * value * chain.turn[k, b]


@kernel
def _add_force(f, above, below, j, chain):
    """Add what the two rows of a force make of it and of the spring, the missing force eliminated."""
    total, apart = above + below, below - above
    chain.force[j, 0], chain.force[j, 1] = total, apart
    left, size, corner = 4.0 * above * below / total, np.sqrt(f[0] * f[0] + f[1] * f[1]), chain.corner
    if j < len(chain.within):
        chain.within[j, 2] += left * size * size
        for i in range(2):
            chain.border[j, 1, _SPRING + i] += left * size * f[2 + i]
    else:
        corner[1, 1] += left * size * size
        for i in range(2):
            corner[1, _SPRING + i] += left * size * f[2 + i]
            corner[_SPRING + i, 1] += left * size * f[2 + i]
    for k in range(2):
        for i in range(2):
            corner[_SPRING + k, _SPRING + i] += left * f[2 + k] * f[2 + i]


@kernel
def _eliminate(chain):
    """Eliminate the chain, interval by interval; what is left is the corner's, inverted."""
    within, onward, border, bordered, corner = chain.within, chain.onward, chain.border, chain.bordered, chain.corner
    for j in range(len(within)):
        own = within[j]
        if j > 0:
            e = onward[j - 1]
            a_1, a_2 = _product(within[j - 1], e[0], e[1])
            b_1, b_2 = _product(within[j - 1], e[1], e[2])
            own[0] -= e[0] * a_1 + e[1] * a_2
            own[1] -= e[0] * b_1 + e[1] * b_2
            own[2] -= e[1] * b_1 + e[2] * b_2
            for b in range(_BORDER):
                less_1, less_2 = _product(e, bordered[j - 1, 0, b], bordered[j - 1, 1, b])
                border[j, 0, b] -= less_1
                border[j, 1, b] -= less_2
        whole = own[0] * own[2] - own[1] * own[1]
        own[0], own[1], own[2] = own[2] / whole, -own[1] / whole, own[0] / whole
        for b in range(_BORDER):
            bordered[j, 0, b], bordered[j, 1, b] = _product(own, border[j, 0, b], border[j, 1, b])
        for a in range(_BORDER):
            for b in range(_BORDER):
                corner[a, b] -= border[j, 0, a] * bordered[j, 0, b] + border[j, 1, a] * bordered[j, 1, b]
    if np.isfinite(np.sum(corner)):
        corner[:] = np.linalg.inv(corner)


@kernel
def solved(program, chain, right, out):
    """Solve for the variables of the program.

    Args:
        program: The program.
        chain: Its matrix, factorised.
        right: By variable; it is changed.
        out: Where to write.
    """
    n = program.rows.shape[0]
    p, corner = out[: 2 * n], np.zeros(_BORDER)
    for j in range(n):
        for k in range(2):
            at = 2 * j + k
            local, coupling, gases = chain.local[j, k], chain.coupling[j, k], right[2 * n + 2 * at : 2 * n + 2 * at + 2]
            first, second = _product(local, gases[0], gases[1])
            right[at] -= coupling[0] * first + coupling[1] * second
            right[(at + 2) % (2 * n)] -= coupling[2] * first + coupling[3] * second
            corner[_TANK] -= program.sign[j, k] * second
        f, missing = program.force[j], chain.force[j, 1] * right[6 * n + j] / chain.force[j, 0]
        right[2 * j] -= f[0] * missing
        right[2 * j + 1] -= f[1] * missing
        right[7 * n] -= f[2] * missing
        right[7 * n + 1] -= f[3] * missing
    turn = chain.turn
    for j in range(n):
        at, other = right[2 * j], right[2 * j + 1]
        right[2 * j], right[2 * j + 1] = turn[0, 0] * at + turn[1, 0] * other, turn[0, 1] * at + turn[1, 1] * other
    for k in range(2):
        corner[k] = right[2 * n - 2 + k]
        corner[_SPRING + k] = right[7 * n + k]
    _along_the_chain(chain, right, corner, p)
    out[7 * n], out[7 * n + 1] = corner[_SPRING], corner[_SPRING + 1]
    for j in range(n):
        along, across = p[2 * j], p[2 * j + 1]
        p[2 * j], p[2 * j + 1] = turn[0, 0] * along + turn[0, 1] * across, turn[1, 0] * along + turn[1, 1] * across
    for j in range(n):
        for k in range(2):
            at = 2 * j + k
            local, coupling, now, then = chain.local[j, k], chain.coupling[j, k], p[at], p[(at + 2) % (2 * n)]
            first = right[2 * n + 2 * at] - coupling[0] * now - coupling[2] * then
            second = right[2 * n + 2 * at + 1] - coupling[1] * now - coupling[3] * then - program.sign[j, k] * corner[_TANK]
            out[2 * n + 2 * at], out[2 * n + 2 * at + 1] = _product(local, first, second)
        f = program.force[j]
        force = f[0] * p[2 * j] + f[1] * p[2 * j + 1] + f[2] * out[7 * n] + f[3] * out[7 * n + 1]
        out[6 * n + j] = (right[6 * n + j] - chain.force[j, 1] * force) / chain.force[j, 0]


@kernel
def _along_the_chain(chain, right, corner, p):
    """Solve for the pressures, and for the border in the corner's place."""
    m = len(chain.within)
    for j in range(m):
        r_1, r_2 = right[2 * j], right[2 * j + 1]
        if j > 0:
            less_1, less_2 = _product(chain.onward[j - 1], p[2 * j - 2], p[2 * j - 1])
            r_1, r_2 = r_1 - less_1, r_2 - less_2
        p[2 * j], p[2 * j + 1] = _product(chain.within[j], r_1, r_2)
        for b in range(_BORDER):
            corner[b] -= chain.border[j, 0, b] * p[2 * j] + chain.border[j, 1, b] * p[2 * j + 1]
    corner[:] = chain.corner @ corner
    p[2 * m], p[2 * m + 1] = corner[0], corner[1]
    for j in range(m - 1, -1, -1):
        for b in range(_BORDER):
            p[2 * j] -= chain.bordered[j, 0, b] * corner[b]
            p[2 * j + 1] -= chain.bordered[j, 1, b] * corner[b]
        if j < m - 1:
            v_1, v_2 = _product(chain.onward[j], p[2 * j + 2], p[2 * j + 3])
            less_1, less_2 = _product(chain.within[j], v_1, v_2)
            p[2 * j] -= less_1
            p[2 * j + 1] -= less_2
