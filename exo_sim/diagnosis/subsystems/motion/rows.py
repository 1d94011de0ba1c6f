"""Rows of a balance of forces: means over short groups of samples that move."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.ndimage import binary_erosion

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.policy import healthy
from exo_sim.diagnosis.policy.recordings import FILTER_ENDS, STEADY_SPEED
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width
from exo_sim.recording.filters import gaussian_width

Array = NDArray[np.float64]

#: Balances are averaged over this time before they are compared [s].
GROUP = 0.02
#: Length of a block of time [s].
BLOCK = 1.0
#: ... and no less than so many widths of the filter: ten of its standard deviations, of which noise shares three with the next block.
INDEPENDENT = 2.5


@dataclass(frozen=True)
class Rows:
    """How the samples of one run become rows.

    Attributes:
        group: Row of each sample, -1 where it is not compared, shape (n,).
        block: Block of time of each row, shape (m,).
        scale: Standard deviation that noise and floor leave in each row, shape (m,).
    """

    group: NDArray[np.int64]
    block: NDArray[np.int64]
    scale: Array

    @property
    def compared(self) -> NDArray[np.bool_]:
        """Which samples are compared, shape (n,)."""
        return self.group >= 0

    def means(self, values: Array) -> Array:
        """Return the mean of each row of values at the samples, shape (m,)."""
        keep = self.compared
        return np.bincount(self.group[keep], weights=values[keep]) / np.bincount(self.group[keep])

    def weights(self) -> sparse.csr_array:
        """Return the matrix of `means`, shape (m, n)."""
        keep = np.flatnonzero(self.compared)
        group = self.group[keep]
        return sparse.csr_array((1.0 / np.bincount(group)[group], (group, keep)), shape=(len(self.block), len(self.group)))


def one_way(run: MotionRun) -> float:
    """Return for how long a joint moves one way where a row of its balance is compared [s]."""
    return _group(run) + smoothing_width(run.time, run.smoothing)


def _group(run: MotionRun) -> float:
    """Return over how long the samples of a row are averaged [s]: as the filter is wider or narrower than usual."""
    return GROUP * smoothing_width(run.time, run.smoothing) / smoothing_width(run.time)


def rows_of(run: MotionRun, usable: NDArray[np.bool_]) -> Rows:
    """Return the rows of one run; samples at rest, where dry friction takes any value up to its level, are not compared.

    Args:
        run: The balance.
        usable: Which samples may be used, shape (n,).
    """
    time, velocity = run.time, run.kinematics.velocity
    step = float(np.median(np.diff(time)))
    width = smoothing_width(time, run.smoothing)
    size = max(1, int(round(_group(run) / step)))
    edge = max(2, int(round(0.5 * width / step)))
    turned = np.diff(np.signbit(velocity), prepend=velocity[0] < 0.0)  # between two samples that both move
    moving = binary_erosion((np.abs(velocity) > run.kinematics.still) & ~turned, iterations=edge)
    moving &= np.abs(np.gradient(velocity, time)) * gaussian_width(width) < STEADY_SPEED * np.abs(velocity)
    good = moving & usable_samples(run, usable, edge)
    group = np.full(len(time), -1)
    firsts: list[int] = []
    for first in range(0, len(time), size):
        chosen = np.arange(first, min(first + size, len(time)))
        if good[chosen].all():
            group[chosen] = len(firsts)
            firsts.append(first)
    # neighbouring samples share the smoothing window: averaging a group of them gains little
    per_row = max(1.0, run.every * GROUP / max(step, 1e-9))
    reduced = row_scale(run) * np.sqrt(min(1.0, 3.0 / per_row) if per_row > 3 else 1.0) if firsts else 0.0
    return Rows(group, block_of(run, np.array(firsts, dtype=int)), np.full(len(firsts), reduced))


def usable_samples(run: MotionRun, usable: NDArray[np.bool_], edge: int = 0) -> NDArray[np.bool_]:
    """Return where a balance is known: all forces recorded, and the filter has enough to take, shape (n,).

    Args:
        run: The balance.
        usable: Which samples may be used, shape (n,).
        edge: So many samples beside an end of a stretch are left out at least.
    """
    good = usable & run.judged & np.isfinite(run.inertia.force + run.drive.force + run.external)
    ends = max(edge, ends_of(run))
    for begin in (0, *run.breaks, len(run.time)):
        good[max(0, begin - ends) : begin + ends] = False
    return np.asarray(good)


def row_scale(run: MotionRun) -> float:
    """Return the standard deviation that noise and floor leave in one sample of the balance [N or N m]."""
    return max(float(np.hypot(run.noise, healthy.FORCE_FLOOR_SHARE * run.effort)), 1e-9)


def block_of(run: MotionRun, at: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return in which block of time samples lie, shape (k,)."""
    length = max(BLOCK, INDEPENDENT * smoothing_width(run.time, run.smoothing))
    return np.asarray((run.time[at] - run.time[0]) / length, dtype=int)


def ends_of(run: MotionRun) -> int:
    """Return beside how many samples of an end of a stretch the filter has nothing to take."""
    step = float(np.median(np.diff(run.time)))
    return math.ceil(FILTER_ENDS * gaussian_width(smoothing_width(run.time, run.smoothing)) / step)
