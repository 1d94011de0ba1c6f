"""Which pressures both chambers of a cylinder should have along a cycle, so that the rod gives its forces from the least gas.

With an edge of its own for each chamber, force leaves one number free: how far both chambers are under pressure together. Gas that is
shut in works as a spring and costs nothing; gas that is let off is bought again. Position and force being known along the cycle, what a
chamber draws in an interval is linear in its pressures (corrected equations 13 to 16, adiabatic, filled at the supply's temperature):

    m = max(0, (V dP + k P dV) / (k R T_s))

so that the least gas of a whole cycle is a linear program, periodic, with the valve's flow and the supply's pressure as bounds. HiGHS
(Huangfu and Hall 2018) solves it. A chamber at the exhaust's pressure grows from there and pays nothing for it; which intervals these are
is settled by solving again.

With a recovery tank a chamber below the tank's pressure may be filled from it, one above may give to it; over a cycle each cylinder takes
no more than it gave, counted by enthalpy (grams at the supply's temperature), which is what an adiabatic tank's pressure goes by. Which
side of the tank's pressure a chamber is on is settled by solving again, too, from the plan without a tank: each pass keeps the one before
as a solution, so none draws more, but the last is a good plan and not surely the best.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from exo_sim.control.chamber_flows import BAR, GRAM, Columns, draw_rows, tank_rows

Array = NDArray[np.float64]
#: Intervals of a cycle.
INTERVALS = 64
#: Share of the supply's pressure that a plan fills a chamber to.
FILLED_TO = 0.97
_KILO = 1e3
#: Springs beside a rod: the stiffest and the softest that is one [N/m], and how far from X = 0 they may be at rest [m].
STIFFEST, _SOFTEST, _FARTHEST = 3e4, 100.0, 0.4
#: A newton that is missing over an interval costs as much as the gas of so many newtons held at full stroke.
_PRICE = 40.0
#: How often the program is solved at the most: while a pass betters the one before.
_PASSES, _TANK_PASSES = 3, 6


@dataclass(frozen=True)
class ChamberPlan:
    """Pressures along a cycle.

    Attributes:
        pressure_1, pressure_2: At even phases [Pa], shape (n,) each.
        gas: Drawn a cycle [kg].
        short: Largest force that is not given [N].
        spring: Stiffness [N/m] and rest [m] of the spring beside the rod with which the gas is least, or None where none was asked for.
        recovered: Taken from the recovery tank a cycle, counted at the supply's temperature [kg].
    """

    pressure_1: Array
    pressure_2: Array
    gas: float
    short: float
    spring: tuple[float, float] | None = None
    recovered: float = 0.0


def plan(world: np.void, c: np.void, x: Array, force: Array, period: float, spring: bool = False) -> ChamberPlan:
    """Return the pressures that give a rod's forces from the least gas.

    Args:
        world, c: Records of the plant and of a cylinder whose valve has independent edges.
        x: Piston position at even phases of a cycle [m], shape (n,).
        force: Of the gas on the rod there [N], shape (n,); of gas and spring together where there is one to choose.
        period: Of the cycle [s].
        spring: Whether a spring beside the rod is to be chosen, too: its force is linear in two numbers, so the program stays one.
    """
    from scipy.optimize import linprog  # most machines follow no plan

    n, p_s, p_e = len(x), float(world["supply_pressure"]), float(world["exhaust_pressure"])
    price = _PRICE * float(c["stroke"]) / float(world["k"] * world["r"] * world["supply_temperature"]) / GRAM
    columns = Columns(n)
    tank = bool(world["tank_volume"] > 0.0 and c["tank_area"] > 0.0)
    a_1, a_2 = float(c["area_1"]), float(c["area_2"])
    unit = sparse.identity(n, format="csr")
    by_spring = sparse.csr_matrix(np.stack([-np.ones(n), -x], axis=1) * _KILO)
    balance = columns.row(p_1=a_1 * BAR * unit, p_2=-a_2 * BAR * unit, missing=unit, excess=-unit, spring=by_spring)
    wanted = force + float(world["atmosphere"]) * (a_1 - a_2)
    turned = columns.row(spring=sparse.csr_matrix([[1.0, -_FARTHEST], [-1.0, -_FARTHEST]]))
    rows, most = draw_rows(world, c, x, period)
    rows, most = sparse.vstack([rows, turned], format="csr"), np.concatenate([most, np.zeros(2)])
    floor, pressures, drawn = p_e / BAR, columns.pair("p"), columns.pair("drawn")
    stiffest = STIFFEST / _KILO if spring else 0.0
    low, high, cost = np.zeros(columns.count), np.full(columns.count, np.inf), np.zeros(columns.count)
    low[pressures], high[pressures] = floor, max(FILLED_TO * p_s, p_e) / BAR
    if c["single_acting"] > 0.0:  # chamber 2 is open
        high[columns.of("p_2")] = floor
    low[columns.of("spring")], high[columns.of("spring")] = [-_FARTHEST * stiffest, 0.0], [_FARTHEST * stiffest, stiffest]
    high[columns.pair("taken")] = high[columns.pair("given")] = 0.0
    cost[drawn], cost[columns.of("missing")], cost[columns.of("excess")] = 1.0, price, price
    if c["single_acting"] > 0.0:
        cost[columns.of("drawn_2")] = 0.0
    least, best = np.inf, None
    limits, right = rows, most
    for _ in range(_TANK_PASSES if tank else _PASSES):
        found = linprog(cost, limits, right, balance, wanted, np.stack([low, high], axis=1), method="highs")
        if found.status != 0 or found.fun > least - 1e-4:
            break
        least, best = float(found.fun), found.x
        held = best[pressures].reshape(2, n)
        idle = held < floor + 1e-3
        free = (idle & np.roll(idle, -1, axis=1)) & (best[drawn].reshape(2, n) > 1e-6)
        if tank:
            below = 0.5 * (held + np.roll(held, -1, axis=1)) < float(world["tank_pressure"]) / BAR
            more, more_right = tank_rows(world, c, below, period)
            limits, right = sparse.vstack([rows, more], format="csr"), np.concatenate([most, more_right])
            high[columns.pair("taken")] = np.where(below, np.inf, 0.0).ravel()
            high[columns.pair("given")] = np.where(below, 0.0, np.inf).ravel()
        elif not free.any():
            break
        cost[drawn][free.ravel()] = 0.0
        high[pressures][(free | np.roll(free, 1, axis=1)).ravel()] = floor
    if best is None:
        still = np.full(n, p_e)
        return ChamberPlan(still, still.copy(), 0.0, float(np.abs(force).max()))
    missing = best[columns.of("missing").start : columns.of("excess").stop]
    start, stiffness = (float(value) * _KILO for value in best[columns.of("spring")])
    return ChamberPlan(
        best[columns.of("p_1")] * BAR, best[columns.of("p_2")] * BAR, float(least - price * missing.sum()) * GRAM, float(missing.max()),
        (stiffness, -start / stiffness) if stiffness > _SOFTEST else None, float(best[columns.pair("taken")].sum()) * GRAM,
    )  # fmt: skip
