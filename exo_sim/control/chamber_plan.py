"""Which pressures both chambers of a cylinder should have along a cycle, so that the rod gives its forces from the least gas.

With an edge of its own for each chamber, force leaves one number free: how far both chambers are under pressure together. Gas that is
shut in works as a spring and costs nothing; gas that is let off is bought again. Position and force being known along the cycle, what a
chamber draws in an interval is linear in its pressures (corrected equations 13 to 16, adiabatic, filled at the supply's temperature):

    m = max(0, (V dP + k P dV) / (k R T_s))

so that the least gas of a whole cycle is a linear program, periodic, with the valve's flow and the supply's pressure as bounds. HiGHS
(Huangfu and Hall 2018) solves it. A chamber at the exhaust's pressure grows from there and pays nothing for it; which intervals these are
is settled by solving again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import linprog

from exo_sim.physics.gas import flow
from exo_sim.physics.nodes import path_areas

Array = NDArray[np.float64]
#: Intervals of a cycle.
INTERVALS = 64
#: Share of a path's flow that a plan uses: the rest is for what no plan foresees.
FLOW_SHARE = 0.7
#: Share of the supply's pressure that a plan fills a chamber to.
FILLED_TO = 0.97
#: Numbers of the program are near one: pressures in bar, gas in grams.
_BAR, _GRAM, _KILO = 1e5, 1e-3, 1e3
#: Springs beside a rod: the stiffest and the softest that is one [N/m], and how far from X = 0 they may be at rest [m].
STIFFEST, _SOFTEST, _FARTHEST = 3e4, 100.0, 0.4
#: A newton that is missing over an interval costs as much as the gas of so many newtons held at full stroke.
_PRICE = 40.0
_PASSES = 3
#: Where the flow through a path is tangent to the lines that bound it: shares of the way from exhaust to supply.
_TANGENTS = (0.02, 0.1, 0.3, 0.6, 0.75, 0.87, 0.95, 0.99)


@dataclass(frozen=True)
class ChamberPlan:
    """Pressures along a cycle.

    Attributes:
        pressure_1, pressure_2: At even phases [Pa], shape (n,) each.
        gas: Drawn a cycle [kg].
        short: Largest force that is not given [N].
        spring: Stiffness [N/m] and rest [m] of the spring beside the rod with which the gas is least, or None where none was asked for.
    """

    pressure_1: Array
    pressure_2: Array
    gas: float
    short: float
    spring: tuple[float, float] | None = None


def plan(world: np.void, c: np.void, x: Array, force: Array, period: float, spring: bool = False) -> ChamberPlan:
    """Return the pressures that give a rod's forces from the least gas.

    Args:
        world, c: Records of the plant and of a double-acting cylinder whose valve has independent edges.
        x: Piston position at even phases of a cycle [m], shape (n,).
        force: Of the gas on the rod there [N], shape (n,); of gas and spring together where there is one to choose.
        period: Of the cycle [s].
        spring: Whether a spring beside the rod is to be chosen, too: its force is linear in two numbers, so the program stays one.
    """
    n, p_s, p_e = len(x), float(world["supply_pressure"]), float(world["exhaust_pressure"])
    k_r_t = float(world["k"] * world["r"] * world["supply_temperature"])
    price = _PRICE * float(c["stroke"]) / k_r_t / _GRAM
    limits, most = _limits(world, c, x, period)
    a_1, a_2 = float(c["area_1"]), float(c["area_2"])
    unit, nothing = sparse.identity(n, format="csr"), sparse.csr_matrix((n, n))
    balance = sparse.hstack([a_1 * _BAR * unit, -a_2 * _BAR * unit, nothing, nothing, unit, -unit], format="csr")
    wanted = force + float(world["atmosphere"]) * (a_1 - a_2)
    # variables: both pressures, gas drawn into both chambers in each interval, force missing and force in excess, the spring's force at
    # x = 0 and its stiffness
    balance = sparse.hstack([balance, sparse.csr_matrix(np.stack([-np.ones(n), -x], axis=1) * _KILO)], format="csr")
    turned = sparse.csr_matrix(([1.0, -_FARTHEST, -1.0, -_FARTHEST], ([0, 0, 1, 1], [6 * n, 6 * n + 1] * 2)), shape=(2, 6 * n + 2))
    limits = sparse.vstack([sparse.hstack([limits, sparse.csr_matrix((limits.shape[0], 2))]), turned], format="csr")
    most = np.concatenate([most, np.zeros(2)])
    floor = p_e / _BAR
    stiffest = STIFFEST / _KILO if spring else 0.0
    low = np.concatenate([np.full(2 * n, floor), np.zeros(4 * n), [-_FARTHEST * stiffest, 0.0]])
    high = np.concatenate([
        np.full(2 * n, max(FILLED_TO * p_s, p_e) / _BAR), np.full(4 * n, np.inf), [_FARTHEST * stiffest, stiffest],
    ])  # fmt: skip
    cost = np.concatenate([np.zeros(2 * n), np.ones(2 * n), np.full(2 * n, price), [0.0, 0.0]])
    least, best = np.inf, None
    for _ in range(_PASSES):
        found = linprog(cost, limits, most, balance, wanted, np.stack([low, high], axis=1), method="highs")
        if found.status != 0 or found.fun > least - 1e-4:
            break
        least, best = float(found.fun), found.x
        idle = best[: 2 * n].reshape(2, n) < floor + 1e-3
        free = (idle & np.roll(idle, -1, axis=1)) & (best[2 * n : 4 * n].reshape(2, n) > 1e-6)
        if not free.any():
            break
        cost[2 * n : 4 * n][free.ravel()] = 0.0
        high[: 2 * n][(free | np.roll(free, 1, axis=1)).ravel()] = floor
    if best is None:
        still = np.full(n, p_e)
        return ChamberPlan(still, still.copy(), 0.0, float(np.abs(force).max()))
    missing = best[4 * n : 6 * n]
    drawn = float(least - price * missing.sum()) * _GRAM
    start, stiffness = (float(value) * _KILO for value in best[6 * n :])
    chosen = (stiffness, -start / stiffness) if stiffness > _SOFTEST else None
    return ChamberPlan(best[:n] * _BAR, best[n : 2 * n] * _BAR, drawn, float(missing.max()), chosen)


def _limits(world: np.void, c: np.void, x: Array, period: float) -> tuple[sparse.csr_matrix, Array]:
    """Return the rows and the right side of what both chambers draw and what the valve lets through."""
    k, r, t_s = float(world["k"]), float(world["r"]), float(world["supply_temperature"])
    p_s, p_e = float(world["supply_pressure"]), float(world["exhaust_pressure"])
    n = len(x)
    unit, nothing = sparse.identity(n, format="csr"), sparse.csr_matrix((n, n))
    at = np.arange(n)
    following = sparse.csr_matrix((np.ones(n), (at, (at + 1) % n)), shape=(n, n))
    middle = 0.5 * (unit + following)
    fed_1, _, fed_2, _ = path_areas(c, 1.0, 1.0)
    _, let_off_1, _, let_off_2 = path_areas(c, -1.0, -1.0)
    rows, most = [], []

    def fill(area: float, q: float) -> float:
        return float(flow(area, p_s, t_s, q, t_s, k, r))

    def empty(area: float, q: float) -> float:
        return float(flow(area, q, t_s, p_e, t_s, k, r))

    for side, volume, fed, let_off in (
        (0, c["dead_volume_1"] + c["area_1"] * x, fed_1, let_off_1),
        (1, c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x), fed_2, let_off_2),
    ):
        after = np.roll(volume, -1)
        raised = sparse.diags(0.5 * (volume + after)) @ (following - unit) + k * sparse.diags(after - volume) @ middle
        draw = raised * (_BAR / _GRAM / (k * r * t_s))

        def row(pressure: sparse.spmatrix, gas: sparse.spmatrix, side: int = side) -> list[sparse.spmatrix]:
            out = [nothing] * 6
            out[side], out[2 + side] = pressure, gas
            return out

        rows.append(row(draw, -unit))
        most.append(np.zeros(n))
        step = FLOW_SHARE * period / n / _GRAM
        for share in _TANGENTS:
            p = p_e + share * (p_s - p_e)
            into, slope_in = _tangent(fill, fed, p)
            out, slope_out = _tangent(empty, let_off, p)
            rows.append(row(-slope_in * step * _BAR * middle, unit))
            most.append(np.full(n, step * (into - slope_in * p)))
            rows.append(row(-draw - slope_out * step * _BAR * middle, nothing))
            most.append(np.full(n, step * (out - slope_out * p)))
    return sparse.vstack([sparse.hstack(each) for each in rows], format="csr"), np.concatenate(most)


def _tangent(through: Callable[[float, float], float], area: float, p: float) -> tuple[float, float]:
    """Return the flow through an area and its slope at a chamber's pressure p [kg/s, kg/(s Pa)]."""
    h = 1e-4 * p
    return through(area, p), (through(area, p + h) - through(area, p - h)) / (2.0 * h)
