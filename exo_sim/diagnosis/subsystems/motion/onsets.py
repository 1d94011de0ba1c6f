"""Onsets of motion: what it takes to start a piston or joint that is at rest.

Rows of a balance lie where it slides steadily; the friction that falls as a motion starts is over by then. About the moment at which a
contact breaks loose the balance peaks. Behind the filter that peak is lower than what it takes, but for what noise adds: part of what the
filter takes lies before it, at rest, where dry friction is less than its level, and part behind it, where it has fallen. So a law is asked
for the same peak behind the filter (`resistance_starting`), and an onset counts only where it exceeds sliding friction (`breakaway`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.data.motion_run import MotionRun
from exo_sim.diagnosis.subsystems.motion.rows import block_of, ends_of, row_scale
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width
from exo_sim.recording.filters import gaussian_width

Array = NDArray[np.float64]

#: For so long it is at rest before an onset, and moves one way behind it, in standard deviations of the filter.
AT_REST, MOVING = 3.5, 5.0
#: So long before an onset it is still held for sure, in the same: how fast its force rises is seen until then.
RISING = 1.5
#: So far to either side of an onset its peak is sought, in the same.
NEAR = 2.0
#: The mean of the largest value within that, of white noise behind the filter and of its second derivative, in standard deviations
#: (400,000 samples, 10 or 20 to a standard deviation of the filter; fewer have less).
LARGEST, LARGEST_ACCELERATION = 0.83, 1.34
#: Below this share of the speed that counts as moving a piston has the speed of noise.
UNKNOWN_SPEED = 0.25


@dataclass(frozen=True)
class Starting:
    """How onsets are read.

    Attributes:
        damping: How fast friction rises with speed where it slides [N s/m or N m s/rad]: a peak is sought beside that.
        scatter: Standard deviation from one onset to the next, where friction acts [N or N m].
        least: What peaks below this says nothing, for it crept before it broke loose, where friction acts [N or N m]; beside a force ...
        constant: ... that is the same in both directions, along +v [N or N m].
    """

    damping: float
    scatter: float = 0.0
    least: float = -math.inf
    constant: float = 0.0


@dataclass(frozen=True)
class Onsets:
    """The onsets of one run.

    Attributes:
        at: Sample of each at which the balance peaks, shape (k,).
        way: Direction of the motion, 1 or -1, shape (k,).
        slowest: Speed above which it is known to move, that of noise [m/s or rad/s].
        acceleration: How fast its speed rises [m/s^2 or rad/s^2], shape (k,), ...
        fastest: ... to what it reaches within the filter [m/s or rad/s], shape (k,).
        rate: How fast what it resists rises before [N/s or N m/s], shape (k,).
        width: Standard deviation of the filter [s].
        damped: What the damping beside which it is read resists there [N or N m], shape (k,), ...
        damping: ... as of `Starting`.
        peak: What resists there beside that, against the motion [N or N m], shape (k,).
        noise: What noise adds to the peak on the mean, as friction does [N or N m], shape (k,).
        block: Block of time of each, shape (k,).
        scale: Standard deviation of the force that is missing there [N or N m], shape (k,).
    """

    at: NDArray[np.int64]
    way: Array
    slowest: float
    acceleration: Array
    fastest: Array
    rate: Array
    width: float
    damped: Array
    damping: float
    peak: Array
    noise: Array
    block: NDArray[np.int64]
    scale: Array

    def means(self, values: Array) -> Array:
        """Return the values at the onsets, shape (k,)."""
        return values[self.at]


def onsets_of(run: MotionRun, usable: NDArray[np.bool_], friction: Array, starting: Starting) -> Onsets:
    """Return the onsets of one run.

    Args:
        run: The balance.
        usable: Which samples may be used, shape (n,).
        friction: What resists it where friction acts, as the balance without any friction says, against +v [N or N m], shape (n,).
        starting: How they are read.
    """
    velocity, slowest, step = run.kinematics.velocity, UNKNOWN_SPEED * run.kinematics.still, float(np.median(np.diff(run.time)))
    width = gaussian_width(smoothing_width(run.time, run.smoothing))
    near, before, rest = (max(int(share * width / step), 1 + k) for k, share in enumerate((NEAR, RISING, AT_REST)))
    starts = _starts(run, usable, max(rest, near), max(int(MOVING * width / step), near + 1))
    way = np.sign(velocity[starts])
    fastest = way * velocity[starts + near]
    acceleration = (fastest - way * velocity[starts]) / (near * step)
    begun = acceleration > 0.0
    starts, way, fastest, acceleration = starts[begun], way[begun], fastest[begun], acceleration[begun]
    window = starts[:, None] + np.arange(-near, near + 1)
    beyond = friction[window] * way[:, None] - starting.damping * np.maximum(velocity[window] * way[:, None], 0.0)
    at = starts - near + beyond.argmax(axis=1)
    damped = starting.damping * np.maximum(way * velocity[at], 0.0)
    peak = way * friction[at] - damped
    kept = peak - starting.constant * way >= starting.least
    at, starts, way, fastest, acceleration = at[kept], starts[kept], way[kept], fastest[kept], acceleration[kept]
    rate = np.maximum(way * (friction[starts - before] - friction[starts - rest]) / ((rest - before) * step), 0.0)
    bias = (LARGEST_ACCELERATION if run.inertia.has_mass else LARGEST) * run.noise
    arm = run.drive.divisor[at]
    return Onsets(
        at, way, slowest, acceleration, fastest, rate, width, way * damped[kept], starting.damping, peak[kept],
        np.sign(arm) * way * bias, block_of(run, at), np.hypot(row_scale(run), starting.scatter * np.abs(arm)),
    )  # fmt: skip


def _starts(run: MotionRun, usable: NDArray[np.bool_], rest: int, moving: int) -> NDArray[np.int64]:
    """Return the first samples that move after so many at rest, and before so many that move on, shape (k,)."""
    velocity, n = run.kinematics.velocity, len(run.time)
    good, ends = usable & run.judged & np.isfinite(run.inertia.force + run.drive.force + run.external), ends_of(run)
    for begin in (0, *run.breaks, n):
        good[max(0, begin - ends) : begin + ends] = False
    moves = np.abs(velocity) > run.kinematics.still
    found = [
        start
        for start in (np.flatnonzero(moves[1:] & ~moves[:-1]) + 1).tolist()
        if rest <= start <= n - moving
        and good[start - rest : start + moving].all()
        and not moves[start - rest : start].any()
        and (velocity[start : start + moving] * velocity[start] > 0.0).all()
    ]
    return np.array(found, dtype=int)
