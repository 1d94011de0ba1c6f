"""How well the recorded pressures of a cylinder follow from its recorded command and motion, under one reading of the columns or another.

Over short intervals the pressure of a chamber changes by

    dP = a * F + b * W,    F = integral of k R T m' / V dt,    W = -integral of k P dV / V

(the paper's equation 13): F is what the rig's valve lets through, W what the piston compresses. On a machine as its rig has it a and b
are near 1; friction, leaks, heat and a valve area that is off by half bend them by tens of per cent. A column in another unit, of the
other chamber or with the other sign bends them by orders of magnitude or turns their signs, so that with a and b held to a generous
range nothing is explained any more. The share of the variance of dP that is explained decides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.physics.compiled import kernel
from exo_sim.physics.nozzle import flow
from exo_sim.recording.windows import mended_at
from exo_sim.rig import Cylinder, Rig

Array = NDArray[np.float64]

#: Bounds of a (a valve's area may be believed wrongly) and of b (isothermal is 1/k).
FLOW_BOUNDS, WORK_BOUNDS = (0.1, 10.0), (0.4, 1.4)
#: Samples that are looked at: so many stretches of so many.
STRETCHES, LENGTH = 8, 6000
#: Pressure changes within an interval are this many times the noise at least.
_CLEAR = 8.0
#: Share that must be explained for a balance to tell from where a pressure counts.
_TELLS = 0.5


@dataclass(frozen=True)
class CylinderColumns:
    """What was recorded of one cylinder, one row a sample, stretches one after another.

    Attributes:
        time: [s], shape (n,).
        breaks: First row of each stretch.
        pressure: Of both chambers, absolute [Pa], shape (2, n); NaN where there is none.
        position: Of the piston, X [m], shape (n,).
        command: Of the valve, shape (n,); zeros where there is none.
        supply, exhaust: [Pa], shape (n,).
        noise: Of each pressure, one standard deviation [Pa].
        command_2: Of the edges of chamber 2 where they are independent, shape (n,); None where one spool serves both.
    """

    time: Array
    breaks: NDArray[np.intp]
    pressure: Array
    position: Array
    command: Array
    supply: Array
    exhaust: Array
    noise: tuple[float, float]
    command_2: Array | None = None

    def towards(self, chamber: int) -> Array:
        """Return the command that opens chamber 0 or 1 to the supply where it is above zero."""
        if chamber == 0:
            return self.command
        return -self.command if self.command_2 is None else self.command_2

    def swapped(self) -> CylinderColumns:
        """Return what it is where each chamber's column holds the other's pressure."""
        return replace(self, pressure=self.pressure[::-1], noise=self.noise[::-1])

    def with_turned_valve(self) -> CylinderColumns:
        """Return what it is where the command has the other sign."""
        return replace(self, command=-self.command, command_2=None if self.command_2 is None else -self.command_2)

    def reversed(self, stroke: float) -> CylinderColumns:
        """Return what it is where the position is counted from the other end."""
        return replace(self, position=stroke - self.position)

    def with_clock(self, factor: float) -> CylinderColumns:
        """Return what it is where the clock runs in another unit."""
        return replace(self, time=factor * self.time)

    def lifted(self, pressure: float) -> CylinderColumns:
        """Return what it is where the chambers' pressures are counted from `pressure`."""
        return replace(self, pressure=self.pressure + pressure)


@dataclass(frozen=True)
class Explained:
    """What the balance explains.

    Attributes:
        share: Of the variance of the pressure changes; 1 is all, 0 none, below 0 worse than no change at all.
        misfit: Sum of squares that is left, relative to the noise.
        intervals: How many there were; 0 where the recording says nothing of it.
        driven: Share of the variance that the valve alone explains at best: whether it says anything of the command.
        worked: The same of the motion.
        opened: Factor of the rig's valve with which it is explained best.
    """

    share: float
    misfit: float
    intervals: int
    driven: float
    worked: float
    opened: float = 1.0


_NOTHING = Explained(0.0, 0.0, 0, 0.0, 0.0)


def explained(columns: CylinderColumns, cylinder: Cylinder, rig: Rig, chambers: Sequence[int] = (0, 1)) -> Explained:
    """Return how much of a cylinder's pressure changes follows from its command and motion, in both chambers or in one of them."""
    from scipy.optimize import lsq_linear

    changes, flows, works = [], [], []
    for chamber in (each for each in chambers if each == 0 or not cylinder.single_acting):
        noise, pressure = columns.noise[chamber], columns.pressure[chamber]
        if not np.isfinite(pressure).any():
            continue
        terms = _terms(columns, cylinder, rig, chamber)
        for stride in (4, 16, 64):
            changed, flowed, worked = (_over(columns, values, stride) for values in terms)
            good = np.isfinite(changed) & np.isfinite(flowed) & np.isfinite(worked)
            if good.sum() >= 20 and np.std(changed[good]) > _CLEAR * noise:
                unit = max(noise, 0.01 * float(np.std(changed[good])))
                changes.append(changed[good] / unit)
                flows.append(flowed[good] / unit)
                works.append(worked[good] / unit)
                break
    if not changes:
        return _NOTHING
    change, terms_ = np.concatenate(changes), np.stack([np.concatenate(flows), np.concatenate(works)], axis=1)
    total = float(change @ change)
    bounds = np.array([FLOW_BOUNDS, WORK_BOUNDS]).T
    scale = np.maximum(np.linalg.norm(terms_, axis=0), 1e-300)
    fitted = lsq_linear(terms_ / scale, change, (bounds[0] * scale, bounds[1] * scale), method="bvls")
    left = float(np.sum((terms_ / scale @ fitted.x - change) ** 2))
    alone = [float((term @ change) ** 2 / max(term @ term, 1e-300)) / total for term in terms_.T]
    return Explained(1.0 - left / total, left, len(change), alone[0], alone[1], float(fitted.x[0] / scale[0]))


#: Atmospheres that are tried in search of the zero from which pressures count.
_OFFSETS = (-0.5, 0.0, 0.5, 1.0, 1.5)


def misfits_by_zero(columns: CylinderColumns, cylinder: Cylinder, rig: Rig, chamber: int, with_supply: bool) -> Array | None:
    """Return a chamber's misfit, relative to the least, with each of some offsets added; None where the balance does not tell.

    Args:
        columns, cylinder, rig, chamber: Whose.
        with_supply: The offset is added to the supply, too: then it tells less, but needs no number of the rig.
    """
    found = []
    for offset in _OFFSETS:
        moved = columns.lifted(offset * rig.environment.pressure)
        if with_supply:
            moved = replace(moved, supply=columns.supply + offset * rig.environment.pressure)
        found.append(explained(moved, cylinder, rig, (chamber,)))
    misfits = np.array([each.misfit for each in found])
    if not found[0].intervals or max(each.share for each in found) < _TELLS:
        return None
    return np.asarray(misfits / misfits.min())


def least_at(misfits: Array, contrast: float) -> float | None:
    """Return where a parabola through misfits has its least, in atmospheres; None where they do not tell.

    They differ by less than `contrast` then, or fall as far as anything is added: that is no zero, but flow that the rig leaves out, a leak
    of a chamber whose valve is hardly open.
    """
    if misfits.max() < contrast * misfits.min() or misfits[-1] <= misfits.min():
        return None
    curvature, slope, _ = np.polyfit(np.array(_OFFSETS), misfits / misfits.min(), 2)
    return float(-0.5 * slope / curvature) if curvature > 0.0 else None


def worse_without(misfits: Array) -> float:
    """Return how many times a chamber's misfit as recorded is that with an atmosphere added: the two ways to write a pressure."""
    return float(misfits[_OFFSETS.index(0.0)] / misfits[_OFFSETS.index(1.0)])


def _terms(columns: CylinderColumns, cylinder: Cylinder, rig: Rig, chamber: int) -> tuple[Array, Array, Array]:
    """Return pressure, flow term and work term of one chamber, summed up over the rows, shape (n,) each."""
    command = columns.towards(chamber)
    travel = columns.position if chamber == 0 else cylinder.stroke - columns.position
    area, dead = (cylinder.area_1, cylinder.dead_volume_1) if chamber == 0 else (cylinder.area_2, cylinder.dead_volume_2)
    least = dead + 0.02 * area * cylinder.stroke  # the smallest volumes are the least certain
    volume = np.maximum(dead + area * travel, least)
    pressure = columns.pressure[chamber]
    k, r = rig.heat_capacity_ratio, rig.specific_gas_constant
    rate = _pressure_rate(
        np.maximum(pressure, 1.0), volume, np.clip(command, -1.0, 1.0) * cylinder.valve_area, columns.supply, columns.exhaust, k, r,
        rig.supply.temperature,
    )  # fmt: skip
    step = np.diff(columns.time, prepend=columns.time[0])
    flowed = np.cumsum(np.nan_to_num(0.5 * (rate + np.roll(rate, 1)) * step))
    middle = 0.5 * (pressure + np.roll(pressure, 1))
    worked = np.cumsum(np.nan_to_num(-k * middle * np.diff(np.log(volume), prepend=math.log(volume[0]))))
    return pressure, flowed, worked


def _over(columns: CylinderColumns, summed: Array, stride: int) -> Array:
    """Return by how much something changed over intervals of `stride` samples that lie within one stretch."""
    edges = [*columns.breaks.tolist(), len(summed)]
    pieces = [np.diff(summed[start:stop:stride]) for start, stop in zip(edges[:-1], edges[1:])]
    return np.concatenate(pieces) if pieces else np.zeros(0)


@kernel
def _pressure_rate(pressure, volume, area, supply, exhaust, k, r, temperature):
    """Return k R T m' / V at each row: what an open path lets in or out, the gas at the temperature of the supply."""
    out = np.empty_like(pressure)
    for i in range(len(pressure)):
        if area[i] >= 0.0:
            m = flow(area[i], supply[i], temperature, pressure[i], temperature, k, r)
        else:
            m = -flow(-area[i], pressure[i], temperature, exhaust[i], temperature, k, r)
        out[i] = k * r * temperature * m / volume[i]
    return out


def stretches(time: Array, rows: Sequence[NDArray[np.bool_]], mended: Sequence[float] = ()) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return rows to look at and where among them each stretch begins: no gap of the clock and no missing sample lies within one.

    Args:
        time: [s], shape (n,).
        rows: Which rows are present, one entry a column that is needed, shape (n,) each.
        mended: Times at which the clock was mended [s].
    """
    step = np.diff(time)
    usual = float(np.median(step)) if len(step) else 1.0
    there = np.logical_and.reduce([np.ones(len(time), dtype=bool), *rows])
    cut = np.flatnonzero(~there | np.concatenate(([False], step > 5.0 * usual)))
    edges = np.unique(np.concatenate(([0], cut, cut + 1, np.array(mended_at(time, mended), dtype=np.intp), [len(time)])))
    spans = [(start, stop) for start, stop in zip(edges[:-1], edges[1:]) if there[start] and stop - start >= 100]
    spans = [(start, min(stop, start + LENGTH)) for begin, stop in spans for start in range(begin, stop, LENGTH) if stop - start >= 100]
    if len(spans) > STRETCHES:
        spans = [spans[i] for i in np.linspace(0, len(spans) - 1, STRETCHES).round().astype(int)]
    chosen = [np.arange(start, stop) for start, stop in spans]
    begins = np.cumsum([0, *(len(each) for each in chosen)])[:-1]
    return (np.concatenate(chosen) if chosen else np.zeros(0, dtype=np.intp)), begins
