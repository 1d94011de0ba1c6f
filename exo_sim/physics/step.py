"""One explicit step of the gas: tried, looked at, and repeated more finely where it was not stable.

`step_length.py` says beforehand how many stages a step needs, from what is known of every effect. Here the step itself is asked: how much
faster the rates became on the way than the state moved is a lower bound on the fastest mode (the nonlinear power method of
Runge-Kutta-Chebyshev solvers, with the step's own change for the vector; Sommeijer, Shampine and Verwer 1997). A mode that the stages
do not reach grows from stage to stage until it shows there, and such a step is not taken.

Where waves pass in a hose the step is the classic one of fourth order (Kutta 1901): it follows a wave through a radian, of which a
Chebyshev step, made for what settles, follows a quarter.
"""

from __future__ import annotations

from exo_sim.physics.balances import rates
from exo_sim.physics.compiled import inlined_kernel
from exo_sim.physics.effects import exhaust_back_pressure, line_restriction, supply_droop
from exo_sim.physics.gas_effects_off import plain
from exo_sim.physics.runge_kutta_chebyshev import COEFFICIENTS, MOST_STAGES, REACH, enough_stages
from exo_sim.physics.state import CONTENTS, DRAWN, HOSE_MASS_1, INTEGRATED, MIDDLE_MASS_1, SHARED_CONTENTS

#: In the place of a number of stages: a classic step; how many stages it has, and the largest h * lambda that it keeps stable, of what
#: settles and of waves alike.
CLASSIC = 0
CLASSIC_STAGES, CLASSIC_REACH = 4, 2.78

#: A change of less than this share of the state says nothing of how fast the state settles.
_SMALLEST_CHANGE = 1e-9

#: How much faster than it was seen to be a mode is taken to be when a step is repeated.
_MARGIN = 1.3


@inlined_kernel
def chebyshev_step(world, cylinders, y, held, x0, v, spool, h, stages, work, x, known, moving):
    """Take one Runge-Kutta-Chebyshev step of `h` seconds, with pistons at x0 moving at v; return the flow drawn and the rate seen.

    The state afterwards is left in work[3], `y` stays as it is.

    Args:
        y: Integrated state, shape (integrated_size,).
        held: The flow that the regulator's diaphragm holds [kg/s].
        spool: Relative openings as of `rates`.
        stages: Two or more.
        work: Scratch, shape (5, integrated_size).
        x: Scratch, shape (n,).
        known: True where the rate need not be seen: it is returned as 0.
        moving: How many of the first numbers of `y` may change (`moving_numbers`).
    """
    n = len(cylinders)
    change, first, before, there, rate = work[0], work[1], work[2], work[3], work[4]  # changes: they round less than what they change
    for q in range(y.size):
        there[q] = y[q]
    drawn = seen = 0.0
    for j in range(1, stages + 1):
        row = COEFFICIENTS[stages, j]
        for i in range(n):
            x[i] = x0[i] + v[i] * row[4] * h
        flow = rates(world, cylinders, there, rate, held, x, v, spool)
        mu, nu, a, b = row[0], row[1], row[2] * h, row[3] * h
        if j == 1:
            drawn = flow
            for q in range(moving):
                first[q] = rate[q]
                before[q] = 0.0
                change[q] = a * rate[q]
                there[q] = y[q] + change[q]
            continue
        if j == stages and not known:
            seen = rate_seen(y, change, first, rate, n)
        for q in range(moving):
            new = mu * change[q] + nu * before[q] + a * rate[q] + b * first[q]
            before[q] = change[q]
            change[q] = new
            there[q] = y[q] + new
    return drawn, seen


@inlined_kernel
def classic_step(world, cylinders, y, held, x0, v, spool, h, work, x, moving):
    """Take one classic Runge-Kutta step of `h` seconds; arguments and what is returned as of `chebyshev_step`."""
    n = len(cylinders)
    total, first, change, there, rate = work[0], work[1], work[2], work[3], work[4]
    for q in range(y.size):
        there[q] = y[q]
    drawn = seen = 0.0
    for j in range(1, CLASSIC_STAGES + 1):
        ahead = 0.0 if j == 1 else h if j == 4 else 0.5 * h
        for i in range(n):
            x[i] = x0[i] + v[i] * ahead
        flow = rates(world, cylinders, there, rate, held, x, v, spool)
        if j == 1:
            drawn = flow
            for q in range(moving):
                change[q] = 0.5 * h * rate[q]
                first[q] = rate[q]
                total[q] = rate[q]
                there[q] = y[q] + change[q]
            continue
        if j == 2:
            seen = rate_seen(y, change, first, rate, n)
        weight, on = (1.0 if j == 4 else 2.0), (h if j == 3 else 0.5 * h)
        for q in range(moving):
            total[q] += weight * rate[q]
            there[q] = y[q] + (h / 6.0 * total[q] if j == 4 else on * rate[q])
    return drawn, seen


@inlined_kernel
def _held(of_cylinder, y, base) -> int:
    """Return how many of the numbers from `base` on say what volumes hold."""
    if not of_cylinder:
        return SHARED_CONTENTS
    if not y[base + HOSE_MASS_1] > 0.0:
        return HOSE_MASS_1
    return CONTENTS if y[base + MIDDLE_MASS_1] > 0.0 else MIDDLE_MASS_1


@inlined_kernel
def rate_seen(y, change, first, rate, n):
    """Return by how much the rates changed for each change of what volumes hold, each in units of it [1/s]; 0 where hardly anything did.

    The largest of all cylinders with their hoses, and of tank and manifold.
    """
    fastest = 0.0
    for i in range(n + 1):
        base = i * INTEGRATED
        moved = answered = 0.0
        for j in range(base, base + _held(i < n, y, base)):
            if y[j] > 0.0:
                share = 1.0 / y[j]
                moved += abs(change[j]) * share
                answered += abs(rate[j] - first[j]) * share
        if answered > fastest * moved and moved > _SMALLEST_CHANGE:
            fastest = answered / moved
    return fastest


@inlined_kernel
def _sound(there, y, n) -> bool:
    """Return whether everything that holds gas still does: no number below zero, none that is no number."""
    for i in range(n + 1):
        base = i * INTEGRATED
        for j in range(base, base + _held(i < n, y, base)):
            if y[j] > 0.0 and not there[j] > 0.0:
                return False
    return True


@inlined_kernel
def all_plain(world, cylinders) -> bool:
    """Return whether nothing but the valves' own paths moves gas: how fast those are is known exactly."""
    known = not supply_droop.present(world.supply_droop) and not exhaust_back_pressure.present(world.exhaust_back_pressure)
    known = known and world.tank_volume <= 0.0
    for i in range(len(cylinders)):
        known = known and plain(cylinders[i])
    return known


@inlined_kernel
def moving_numbers(world, cylinders, y) -> int:
    """Return how many of the first integrated numbers change at all where nobody reads the books."""
    shared = supply_droop.present(world.supply_droop) or exhaust_back_pressure.present(world.exhaust_back_pressure)
    if shared or world.tank_volume > 0.0 or len(cylinders) > 1:
        return y.size
    c = cylinders[0]
    if c.moving_wall_temperature.heat_capacity > 0.0 or line_restriction.has_inertia(c.line_restriction):
        return DRAWN
    return MIDDLE_MASS_1 if line_restriction.present(c.line_restriction) else HOSE_MASS_1


@inlined_kernel
def integrate(world, cylinders, y, held, x0, x1, span, spool, h, stages, work, x, v, most, known, moving):
    """Advance the integrated state by `h` seconds with pistons moving evenly from x0 to x1 over `span`.

    Return the flow drawn at the start, how many steps were tried, and the rate that the stages must reach where they did not [1/s]. One
    step is tried as a rule, more than `most` where the gas is too fast for that many; then the state is left where it could be followed
    to. `x0` (n,) is moved on to where the pistons are afterwards.

    Args:
        work: Scratch, shape (5, integrated_size).
        x, v: Scratch, shape (n,).
        most: Steps that may be tried.
        known: True where the stages are surely enough (`all_plain`): then the step is not asked.
        moving: How many of the first numbers of `y` may change; of `work` the rest is zero where that is less than all.
    """
    n = len(cylinders)
    for i in range(n):
        v[i] = (x1[i] - x0[i]) / span
    there = work[3]
    left, piece, first, tried, faster = h, h, 0.0, 0, 0.0
    while left > 0.0:
        tried += 1
        if tried > most:
            break
        if stages == CLASSIC:
            drawn, seen = classic_step(world, cylinders, y, held, x0, v, spool, piece, work, x, moving)
        else:
            drawn, seen = chebyshev_step(world, cylinders, y, held, x0, v, spool, piece, stages, work, x, known, moving)
        if tried == 1:
            first = drawn
        unstable = not seen * piece <= (CLASSIC_REACH if stages == CLASSIC else REACH[stages])
        if _sound(there, y, n) and not unstable:
            for q in range(moving):
                y[q] = there[q]
            for i in range(n):
                x0[i] += v[i] * piece
            left = left - piece if piece < left else 0.0
            piece = min(2.0 * piece, left)
            continue
        if unstable and seen > 0.0:
            faster = max(faster, _MARGIN * seen)
        if unstable and stages != CLASSIC:
            if faster * piece <= REACH[MOST_STAGES]:
                stages = max(enough_stages(faster * piece), stages + 1)
                continue
            stages = MOST_STAGES
        piece *= 0.5
    return first, tried, faster
