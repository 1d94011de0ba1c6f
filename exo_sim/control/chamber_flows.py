"""What chambers draw along a cycle and what their valves let through, as rows of the linear program of `chamber_plan`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

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
        self.step = FLOW_SHARE * period / n / GRAM
        fed_1, _, fed_2, _ = path_areas(c, 1.0, 1.0)
        _, let_off_1, _, let_off_2 = path_areas(c, -1.0, -1.0)
        self.fed, self.let_off = (fed_1, fed_2), (let_off_1, let_off_2)

    def raised(self, volume: Array) -> tuple[Array, Array]:
        """Return what changes a chamber's pressures as planned, volumes given, shape (n,) [g at the supply's temperature].

        It is linear in the pressure at each interval's start and at its end: what a bar of either counts, shape (n,) each.
        """
        after = np.roll(volume, -1)
        filled, grown, unit = 0.5 * (volume + after), 0.5 * (self.k * (after - volume)), BAR / GRAM / (self.k * self.r * self.t_s)
        return (grown - filled) * unit, (filled + grown) * unit

    def into(self, area: float, p_up: float) -> Callable[[float], float]:
        """Return the flow from a pressure into a chamber, by the chamber's [kg/s]."""
        return lambda p: float(flow(area, p_up, self.t_s, p, self.t_s, self.k, self.r))

    def out_of(self, area: float, p_down: float) -> Callable[[float], float]:
        """Return the flow from a chamber to a pressure, by the chamber's [kg/s]."""
        return lambda p: float(flow(area, p, self.t_s, p_down, self.t_s, self.k, self.r))


class _RowList:
    """Rows of the program, gathered as the numbers that are not zero: a matrix for each block would cost more than the program itself."""

    def __init__(self, columns: Columns):
        self.columns, self.height = columns, 0
        self._row: list[NDArray[np.intp]] = []
        self._column: list[NDArray[np.intp]] = []
        self._value: list[Array] = []
        self._most: list[Array] = []

    def add(self, at: NDArray[np.intp], most: float, blocks: Mapping[str, float | tuple[Array | float, Array | float]]) -> None:
        """Add a row for each of some intervals.

        Args:
            at: The intervals, shape (m,).
            most: Right side of all of them.
            blocks: By the name of a variable what it counts in its own interval, or that and what it counts in the next.
        """
        rows = self.height + np.arange(len(at))
        for name, value in blocks.items():
            start = self.columns.of(name).start
            for later, each in enumerate(value if isinstance(value, tuple) else (value,)):
                self._row.append(rows)
                self._column.append(start + (at + later) % self.columns.n)
                self._value.append(np.broadcast_to(each, at.shape))
        self._most.append(np.full(len(at), most))
        self.height += len(at)

    def add_balance(self, **signs: float) -> None:
        """Add one row, at most zero, over all intervals: each variable by its sign."""
        for name, sign in signs.items():
            place, n = self.columns.of(name), self.columns.n
            self._row.append(np.full(n, self.height))
            self._column.append(np.arange(place.start, place.stop))
            self._value.append(np.full(n, sign))
        self._most.append(np.zeros(1))
        self.height += 1

    def rows(self) -> Rows:
        """Return them with their right side."""
        places = np.concatenate(self._row), np.concatenate(self._column)
        return sparse.csr_matrix((np.concatenate(self._value), places), (self.height, self.columns.count)), np.concatenate(self._most)


def draw_rows(world: np.void, c: np.void, x: Array, period: float) -> Rows:
    """Return the rows and the right side of what both chambers draw and what the valve lets through to supply and exhaust.

    Args:
        world, c: Records of the plant and the cylinder.
        x: Piston position at even phases of the cycle [m], shape (n,).
        period: Of the cycle [s].
    """
    cycle, found, every = _Cycle(world, c, len(x), period), _RowList(Columns(len(x))), np.arange(len(x))
    volumes = c["dead_volume_1"] + c["area_1"] * x, c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x)
    for side, volume in enumerate(volumes, 1):
        p, drawn, taken, given = f"p_{side}", f"drawn_{side}", f"taken_{side}", f"given_{side}"
        now, then = cycle.raised(volume)
        found.add(every, 0.0, {p: (now, then), drawn: -1.0, taken: -1.0, given: 1.0})
        for share in _TANGENTS:
            pressure = cycle.p_e + share * (cycle.p_s - cycle.p_e)
            slope, start = _tangent(cycle.into(cycle.fed[side - 1], cycle.p_s), pressure, cycle.step)
            found.add(every, start, {p: (-0.5 * slope, -0.5 * slope), drawn: 1.0})
            slope, start = _tangent(cycle.out_of(cycle.let_off[side - 1], cycle.p_e), pressure, cycle.step)
            found.add(every, start, {p: (-now - 0.5 * slope, -then - 0.5 * slope), given: -1.0})
    return found.rows()


def tank_rows(world: np.void, c: np.void, below: NDArray[np.bool_], period: float) -> Rows:
    """Return the rows and the right side of what the paths to a recovery tank let through, and of the balance of the tank.

    Args:
        world, c: Records of the plant and the cylinder.
        below: Whether a chamber is below the tank's pressure, or above, in each interval, shape (2, n); the rows keep it there.
        period: Of the cycle [s].
    """
    n, p_t, area = below.shape[1], float(world["tank_pressure"]), float(c["tank_area"])
    cycle, found = _Cycle(world, c, n, period), _RowList(Columns(n))
    found.add_balance(taken_1=1.0, taken_2=1.0, given_1=-1.0, given_2=-1.0)
    for side, low in enumerate(below, 1):
        for kind, where, ends, through in (
            ("taken", low, (cycle.p_e, p_t), cycle.into(area, p_t)),
            ("given", ~low, (p_t, cycle.p_s), cycle.out_of(area, p_t)),
        ):
            at = np.flatnonzero(where)
            for share in _TANGENTS if len(at) else ():
                slope, start = _tangent(through, ends[0] + share * (ends[1] - ends[0]), cycle.step)
                found.add(at, start, {f"p_{side}": (-0.5 * slope, -0.5 * slope), f"{kind}_{side}": 1.0})
    return found.rows()


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
