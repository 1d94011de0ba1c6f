"""Which pressures both chambers of a cylinder should have along a cycle, so that the rod gives its forces from the least gas.

With an edge of its own for each chamber, force leaves one number free: how far both chambers are under pressure together. Gas that is
shut in works as a spring and costs nothing; gas that is let off is bought again. Position and force being known along the cycle, what a
chamber draws in an interval is linear in its pressures (corrected equations 13 to 16, adiabatic, filled at the supply's temperature):

    m = max(0, (V dP + k P dV) / (k R T_s))

so that the least gas of a whole cycle is a linear program, periodic, with the valve's flow and the supply's pressure as bounds
(`pressure_plan_solver` solves it). A chamber at the exhaust's pressure grows from there and pays nothing for it; which intervals these are
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

from exo_sim.control.pressure_plan_constraints import BAR, GRAM, ChamberRows
from exo_sim.control.pressure_plan_solver import Program, solve

Array = NDArray[np.float64]
#: Intervals of a cycle.
INTERVALS = 64
_KILO = 1e3
#: Springs beside a rod: the stiffest and the softest that is one [N/m], and how far from X = 0 they may be at rest [m].
STIFFEST, _SOFTEST, _FARTHEST = 3e4, 100.0, 0.4
#: A newton that is missing over an interval costs as much as the gas of so many newtons held at full stroke.
_PRICE = 40.0
#: Force below which none is missing [N].
_LEAST_SHORT = 1e-2
#: How often the program is solved at the most: while a pass betters the one before.
_PASSES, _TANK_PASSES = 3, 6
#: A pass betters the one before by more than this [g]; a pressure at the exhaust's is within this [bar], gas is drawn above this [g].
_BETTER, _AT_EXHAUST, _DRAWN = 1e-4, 1e-3, 1e-6
#: What a gram through the tank costs, of one drawn: little, but gas is not drawn to be led round through it.
_EXCHANGED = 1e-3
#: What a spring's two numbers count in its bounds: its rest within reach either way, no stiffer than the stiffest, and no less than none.
_TURNED = np.array([[1.0, -_FARTHEST], [-1.0, -_FARTHEST], [0.0, 1.0], [0.0, -1.0]])


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
    n, p_e = len(x), float(world["exhaust_pressure"])
    price = _PRICE * float(c["stroke"]) / float(world["k"] * world["r"] * world["supply_temperature"]) / GRAM
    tank = bool(world["tank_volume"] > 0.0 and c["tank_area"] > 0.0)
    a_1, a_2 = float(c["area_1"]), float(c["area_2"])
    chambers, cost, sign = ChamberRows(world, c, x, period), np.ones((n, 2, 2)), np.zeros((n, 2))
    if c["single_acting"] > 0.0:
        cost[:, 1, 0] = 0.0
    ones = np.ones(n)
    program = Program(
        *chambers.rows(), cost, sign, price * np.stack([a_1 * BAR * ones, -a_2 * BAR * ones, -_KILO * ones, -_KILO * x], axis=1),
        price * (force + float(world["atmosphere"]) * (a_1 - a_2)), _TURNED, np.array([0.0, 0.0, STIFFEST / _KILO if spring else 0.0, 0.0]),
    )  # fmt: skip
    least, best = np.inf, None
    for _ in range(_TANK_PASSES if tank else _PASSES):
        found = solve(program)
        drawn = float(np.sum(program.cost[:, :, 0] * found.gas[:, :, 0]) + found.missing.sum())
        if not found.found or drawn > least - _BETTER:
            break
        least, best, recovered = drawn, found, float(np.sum(np.maximum(program.sign, 0.0) * found.gas[:, :, 1]))
        idle = found.pressure < chambers.floor + _AT_EXHAUST
        free = idle & np.roll(idle, -1, axis=0) & (found.gas[:, :, 0] > _DRAWN) & (cost[:, :, 0] > 0.0)
        before = sign
        if tank:
            below = 0.5 * (found.pressure + np.roll(found.pressure, -1, axis=0)) < float(world["tank_pressure"]) / BAR
            sign = np.where(below, 1.0, -1.0)
            cost[:, :, 1] = _EXCHANGED
        if not free.any() and np.array_equal(sign, before):
            break
        cost[:, :, 0][free] = 0.0
        chambers.keep_idle(*np.nonzero(free | np.roll(free, 1, axis=0)))
        rows, most = chambers.rows(below if tank else None)
        program = program._replace(rows=rows, most=most, sign=sign)
    if best is None:
        still = np.full(n, p_e)
        return ChamberPlan(still, still.copy(), 0.0, float(np.abs(force).max()))
    start, stiffness = (float(value) * _KILO for value in best.spring)
    short, gas = float(best.missing.max()) / price, float(least - best.missing.sum())
    return ChamberPlan(
        best.pressure[:, 0] * BAR, best.pressure[:, 1] * BAR, gas * GRAM, short if short > _LEAST_SHORT else 0.0,
        (stiffness, -start / stiffness) if stiffness > _SOFTEST else None, recovered * GRAM,
    )  # fmt: skip
