"""What chambers draw along a cycle and what their valves let through, as rows of the linear program of `chamber_plan`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from exo_sim.physics.nodes import path_areas
from exo_sim.physics.nozzle import flow

Array = NDArray[np.float64]
Rows = tuple[sparse.csr_matrix, Array]
#: Numbers of the program are near one: pressures in bar, gas in grams.
BAR, GRAM = 1e5, 1e-3
#: Share of a path's flow that a plan uses: the rest is for what no plan foresees.
FLOW_SHARE = 0.7
#: Where the flow through a path is tangent to the lines that bound it: shares of the way from the lower pressure to the higher.
_TANGENTS = (0.02, 0.1, 0.3, 0.6, 0.75, 0.87, 0.95, 0.99)


class Columns:
    """The variables of the program, one for each interval: pressures [bar] at its start; gas drawn in it, force missing and in excess [N],
    gas taken from the tank and given to it [g]. Of the spring two alone: its force at X = 0 [kN] and its stiffness [kN/m]."""

    _NAMES = ("p_1", "p_2", "drawn_1", "drawn_2", "missing", "excess", "taken_1", "taken_2", "given_1", "given_2", "spring")

    def __init__(self, n: int):
        self.n, self.count = n, (len(self._NAMES) - 1) * n + 2

    def of(self, name: str) -> slice:
        """Return the places of one kind."""
        start = self._NAMES.index(name) * self.n
        return slice(start, start + (2 if name == "spring" else self.n))

    def pair(self, name: str) -> slice:
        """Return the places of what both chambers have, chamber 1 first."""
        return slice(self.of(f"{name}_1").start, self.of(f"{name}_2").stop)

    def row(self, **blocks: sparse.spmatrix) -> sparse.csr_matrix:
        """Return rows with some blocks, zero elsewhere."""
        height = next(iter(blocks.values())).shape[0]
        return sparse.hstack(
            [blocks.get(name, sparse.csr_matrix((height, 2 if name == "spring" else self.n))) for name in self._NAMES], format="csr"
        )


class _Cycle:
    """Intervals of a cycle of a cylinder.

    Args:
        world, c: Records of the plant and the cylinder.
        n: Intervals.
        period: Of the cycle [s].
    """

    def __init__(self, world: np.void, c: np.void, n: int, period: float):
        self.k, self.r, self.t_s = float(world["k"]), float(world["r"]), float(world["supply_temperature"])
        self.p_s, self.p_e = float(world["supply_pressure"]), float(world["exhaust_pressure"])
        at = np.arange(n)
        self.unit = sparse.identity(n, format="csr")
        self.following = sparse.csr_matrix((np.ones(n), (at, (at + 1) % n)), shape=(n, n))
        self.middle = 0.5 * (self.unit + self.following)
        self.step = FLOW_SHARE * period / n / GRAM
        fed_1, _, fed_2, _ = path_areas(c, 1.0, 1.0)
        _, let_off_1, _, let_off_2 = path_areas(c, -1.0, -1.0)
        self.fed, self.let_off = (fed_1, fed_2), (let_off_1, let_off_2)

    def raised(self, volume: Array) -> sparse.csr_matrix:
        """Return what changes a chamber's pressures as planned, volumes given, shape (n,) [g at the supply's temperature]."""
        after = np.roll(volume, -1)
        rate = sparse.diags(0.5 * (volume + after)) @ (self.following - self.unit) + self.k * sparse.diags(after - volume) @ self.middle
        return rate * (BAR / GRAM / (self.k * self.r * self.t_s))

    def into(self, area: float, p_up: float) -> Callable[[float], float]:
        """Return the flow from a pressure into a chamber, by the chamber's [kg/s]."""
        return lambda p: float(flow(area, p_up, self.t_s, p, self.t_s, self.k, self.r))

    def out_of(self, area: float, p_down: float) -> Callable[[float], float]:
        """Return the flow from a chamber to a pressure, by the chamber's [kg/s]."""
        return lambda p: float(flow(area, p, self.t_s, p_down, self.t_s, self.k, self.r))


def draw_rows(world: np.void, c: np.void, x: Array, period: float) -> Rows:
    """Return the rows and the right side of what both chambers draw and what the valve lets through to supply and exhaust.

    Args:
        world, c: Records of the plant and the cylinder.
        x: Piston position at even phases of the cycle [m], shape (n,).
        period: Of the cycle [s].
    """
    n = len(x)
    at, columns = _Cycle(world, c, n, period), Columns(n)
    rows, most = [], []
    volumes = c["dead_volume_1"] + c["area_1"] * x, c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x)
    for side, volume in enumerate(volumes, 1):
        p, drawn, taken, given = f"p_{side}", f"drawn_{side}", f"taken_{side}", f"given_{side}"
        raised, unit = at.raised(volume), at.unit
        rows.append(columns.row(**{p: raised, drawn: -unit, taken: -unit, given: unit}))
        most.append(np.zeros(n))
        for share in _TANGENTS:
            pressure = at.p_e + share * (at.p_s - at.p_e)
            slope, start = _tangent(at.into(at.fed[side - 1], at.p_s), pressure, at.step)
            rows.append(columns.row(**{p: -slope * at.middle, drawn: unit}))
            most.append(np.full(n, start))
            slope, start = _tangent(at.out_of(at.let_off[side - 1], at.p_e), pressure, at.step)
            rows.append(columns.row(**{p: -raised - slope * at.middle, given: -unit}))
            most.append(np.full(n, start))
    return sparse.vstack(rows, format="csr"), np.concatenate(most)


def tank_rows(world: np.void, c: np.void, below: NDArray[np.bool_], period: float) -> Rows:
    """Return the rows and the right side of what the paths to a recovery tank let through, and of the balance of the tank.

    Args:
        world, c: Records of the plant and the cylinder.
        below: Whether a chamber is below the tank's pressure, or above, in each interval, shape (2, n); the rows keep it there.
        period: Of the cycle [s].
    """
    n, p_t, area = below.shape[1], float(world["tank_pressure"]), float(c["tank_area"])
    at, columns = _Cycle(world, c, n, period), Columns(n)
    balance = [columns.row(**{f"{what}_{side}": sparse.csr_matrix(np.full((1, n), sign)) for side in (1, 2)})
               for what, sign in (("taken", 1.0), ("given", -1.0))]  # fmt: skip
    rows, most = [balance[0] + balance[1]], [np.zeros(1)]
    for side, low in enumerate(below, 1):
        for kind, where, ends, through in (
            ("taken", low, (at.p_e, p_t), at.into(area, p_t)),
            ("given", ~low, (p_t, at.p_s), at.out_of(area, p_t)),
        ):
            if not where.any():
                continue
            for share in _TANGENTS:
                slope, start = _tangent(through, ends[0] + share * (ends[1] - ends[0]), at.step)
                rows.append(columns.row(**{f"p_{side}": -slope * at.middle[where], f"{kind}_{side}": at.unit[where]}))
                most.append(np.full(int(where.sum()), start))
    return sparse.vstack(rows, format="csr"), np.concatenate(most)


def _tangent(through: Callable[[float], float], p: float, step: float) -> tuple[float, float]:
    """Return slope [g/bar] and value at 0 bar [g] of the line that touches a flow over an interval at a chamber's pressure p [Pa].

    Args:
        through: Flow by the chamber's pressure [kg/s].
        p: Where.
        step: Length of the interval [s] times the grams of a kilogram.
    """
    h = 1e-4 * p
    slope = (through(p + h) - through(p - h)) / (2.0 * h)
    return slope * step * BAR, step * (through(p) - slope * p)
