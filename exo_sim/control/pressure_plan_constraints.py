"""What a chamber draws along a cycle and what its paths let through, as rows of the linear program of `pressure_plan`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.nodes import path_areas
from exo_sim.physics.nozzle import flow

Array = NDArray[np.float64]
#: Numbers of the program are near one: pressures in bar, gas in grams.
BAR, GRAM = 1e5, 1e-3
#: Share of a path's flow that a plan uses: the rest is for what no plan foresees.
FLOW_SHARE = 0.7
#: Share of the supply's pressure that a plan fills a chamber to.
FILLED_TO = 0.97
#: Where the flow through a path is tangent to the lines that bound it: shares of the way from the lower pressure to the higher.
_TANGENTS = (0.02, 0.1, 0.3, 0.6, 0.75, 0.87, 0.95, 0.99)
#: A tangent counts as the one before where it differs by less: those of a choked flow are one line.
_SAME = 1e-6
#: Between two bounds of a pressure that is not free [bar]: a solver by interior points asks for some room.
_ROOM = 1e-4


class ChamberRows:
    """Rows of both chambers of a cylinder, for `pressure_plan_solver.Program`; (n, 2, m, 4) and (n, 2, m) of its `rows` and `most`.

    The first row is what a chamber's pressures ask for, which it draws, or exchanges with the tank; the last four are bounds: nothing
    is drawn backwards, nothing exchanged backwards, and the least and the largest pressure.

    Args:
        world, c: Records of the plant and the cylinder.
        x: Piston position at even phases of the cycle [m], shape (n,).
        period: Of the cycle [s].
    """

    def __init__(self, world: np.void, c: np.void, x: Array, period: float):
        n, p_s, p_e = len(x), float(world["supply_pressure"]), float(world["exhaust_pressure"])
        self.k, self.r, self.t_s = float(world["k"]), float(world["r"]), float(world["supply_temperature"])
        self.step = FLOW_SHARE * period / n / GRAM
        self.floor, high = p_e / BAR, max(FILLED_TO * p_s, p_e) / BAR
        fed_1, _, fed_2, _ = path_areas(c, 1.0, 1.0)
        _, let_off_1, _, let_off_2 = path_areas(c, -1.0, -1.0)
        fed = [self._tangents(self._into(area, p_s), p_e, p_s) for area in (fed_1, fed_2)]
        let_off = [self._tangents(self._out_of(area, p_e), p_e, p_s) for area in (let_off_1, let_off_2)]
        p_t, area = float(world["tank_pressure"]), float(c["tank_area"])
        self._taken = self._tangents(self._into(area, p_t), p_e, p_t)
        self._given = self._tangents(self._out_of(area, p_t), p_t, p_s)
        self._supply = slice(1, 1 + max(map(len, fed)))
        self._exhaust = slice(self._supply.stop, self._supply.stop + max(map(len, let_off)))
        self._tank = slice(self._exhaust.stop, self._exhaust.stop + max(len(self._taken), len(self._given)))
        self._plain, self._most = np.zeros((n, 2, self._tank.stop + 4, 4)), np.zeros((n, 2, self._tank.stop + 4))
        volumes = c["dead_volume_1"] + c["area_1"] * x, c["dead_volume_2"] + c["area_2"] * (c["stroke"] - x)
        for k, volume in enumerate(volumes):
            raised, rows, most = self._raised(volume), self._plain[:, k], self._most[:, k]
            rows[:, 0, :2], rows[:, 0, 2] = raised, -1.0
            slope, start = _filled_up(fed[k], self._supply).T
            rows[:, self._supply, :2], rows[:, self._supply, 2], most[:, self._supply] = -0.5 * slope[:, None], 1.0, start
            slope, start = _filled_up(let_off[k], self._exhaust).T
            rows[:, self._exhaust, :2], most[:, self._exhaust] = -raised[:, None, :] - 0.5 * slope[:, None], start
            rows[:, -4, 2], rows[:, -3, 3], rows[:, -2, 0], rows[:, -1, 0] = -1.0, -1.0, -1.0, 1.0
            most[:, -2], most[:, -1] = -self.floor, high
            most[:, self._tank] = 1.0  # no path, no bound
        if c["single_acting"] > 0.0:  # chamber 2 is open
            self.keep_idle(np.arange(n), np.full(n, 1))

    def keep_idle(self, interval: NDArray[np.intp], side: NDArray[np.intp]) -> None:
        """Keep chambers (0 or 1) at the exhaust's pressure at the start of some intervals."""
        self._most[interval, side, -1] = self.floor + _ROOM

    def rows(self, below: NDArray[np.bool_] | None = None) -> tuple[Array, Array]:
        """Return rows and right sides.

        Args:
            below: With a tank: whether a chamber is below its pressure, or above, in each interval, (n, 2); the rows keep it there.
        """
        if below is None:
            return self._plain, self._most
        rows, most = self._plain.copy(), self._most.copy()
        rows[:, :, 0, 3] = np.where(below, -1.0, 1.0)
        rows[:, :, self._exhaust, 3] = np.where(below, 0.0, -1.0)[:, :, None]
        for lines, where in ((self._taken, below), (self._given, ~below)):
            slope, start = _filled_up(lines, self._tank).T
            tank = np.stack([-0.5 * slope, -0.5 * slope, np.zeros_like(slope), np.ones_like(slope)], axis=1)
            rows[:, :, self._tank] = np.where(where[:, :, None, None], tank, rows[:, :, self._tank])
            most[:, :, self._tank] = np.where(where[:, :, None], start, most[:, :, self._tank])
        return rows, most

    def _raised(self, volume: Array) -> Array:
        """Return what changes a chamber's pressures as planned, volumes given, shape (n,) [g at the supply's temperature].

        It is linear in the pressure at each interval's start and at its end: what a bar of either counts, shape (n, 2).
        """
        after = np.roll(volume, -1)
        filled, grown, unit = 0.5 * (volume + after), 0.5 * (self.k * (after - volume)), BAR / GRAM / (self.k * self.r * self.t_s)
        return np.stack([(grown - filled) * unit, (filled + grown) * unit], axis=1)

    def _into(self, area: float, p_up: float) -> Callable[[float], float]:
        """Return the flow from a pressure into a chamber, by the chamber's [kg/s]."""
        return lambda p: float(flow(area, p_up, self.t_s, p, self.t_s, self.k, self.r))

    def _out_of(self, area: float, p_down: float) -> Callable[[float], float]:
        """Return the flow from a chamber to a pressure, by the chamber's [kg/s]."""
        return lambda p: float(flow(area, p, self.t_s, p_down, self.t_s, self.k, self.r))

    def _tangents(self, through: Callable[[float], float], low: float, high: float) -> list[tuple[float, float]]:
        """Return lines that bound what flows in an interval, by the chamber's pressure: slope [g/bar] and value at 0 bar [g] of each."""
        found: list[tuple[float, float]] = []
        for share in _TANGENTS:
            p = low + share * (high - low)
            h = 1e-4 * p
            slope = (through(p + h) - through(p - h)) / (2.0 * h)
            line = slope * self.step * BAR, self.step * (through(p) - slope * p)
            same = found and abs(line[0] - found[-1][0]) * p / BAR + abs(line[1] - found[-1][1]) <= _SAME * self.step * through(p)
            if not same:
                found.append(line)
        return found


def _filled_up(lines: list[tuple[float, float]], rows: slice) -> Array:
    """Return lines for so many rows, the last one again where there are fewer, shape (m, 2)."""
    return np.array([lines[min(i, len(lines) - 1)] for i in range(rows.stop - rows.start)])
