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
from exo_sim.diagnosis.policy.recordings import ONSET_MOTION, ONSET_REST
from exo_sim.diagnosis.subsystems.motion.rows import block_of, row_scale, usable_samples
from exo_sim.diagnosis.subsystems.motion.smoothing import smoothing_width
from exo_sim.recording.filters import gaussian_width

Array = NDArray[np.float64]

#: So long before an onset it is still held for sure, in standard deviations of the filter: how fast its force rises is seen until then.
RISING = 1.5
#: So far behind an onset its peak is sought, in the same; before it as far as it is surely at rest, for what is held there is no more.
NEAR = 2.0
#: The mean of the largest value within that, of white noise behind the filter and of its second derivative, in standard deviations
#: (400,000 samples, 10 or 20 to a standard deviation of the filter; fewer have less).
LARGEST, LARGEST_ACCELERATION = 0.83, 1.34
#: The variance of the derivative of both, in that of either over the square of that standard deviation: derived, of a Gaussian spectrum.
STEEP, STEEP_ACCELERATION = 0.5, 2.5
#: So far to either side of a peak its curvature is read, in the same.
CURVED = 0.75
#: As a contact breaks loose it slides all but not, at this share of the speed that counts as moving.
LEAST_SPEED = 1e-3


@dataclass(frozen=True)
class Starting:
    """How onsets are read.

    Attributes:
        damping: How fast friction rises with speed where it slides [N s/m or N m s/rad]: a peak is sought beside that.
        scatter: Standard deviation from one onset to the next, where friction acts [N or N m].
        least: Peaks below this are rejected, where friction acts [N or N m]: such a contact crept before it broke loose; beside a force ...
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
        slowest: Speed as it breaks loose, all but nil [m/s or rad/s].
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
        """Return the values at the onsets, shape (k,): what rows of the motion have as a mean is that of one sample here."""
        return values[self.at]


def onsets_of(run: MotionRun, usable: NDArray[np.bool_], friction: Array, starting: Starting) -> Onsets:
    """Return the onsets of one run.

    Args:
        run: The balance.
        usable: Which samples may be used, shape (n,).
        friction: What resists it where friction acts, as the balance without any friction says, against +v [N or N m], shape (n,).
        starting: How they are read.
    """
    velocity, step = run.kinematics.velocity, float(np.median(np.diff(run.time)))
    slowest = LEAST_SPEED * run.kinematics.still
    width = gaussian_width(smoothing_width(run.time, run.smoothing))
    near, before, rest = (max(int(share * width / step), 1 + k) for k, share in enumerate((NEAR, RISING, ONSET_REST)))
    beside = max(int(CURVED * width / step), 1)
    starts = _starts(run, usable, rest + beside, max(int(ONSET_MOTION * width / step), near + beside + 1))
    way = np.sign(velocity[starts])
    fastest = way * velocity[starts + near]
    acceleration = (fastest - way * velocity[starts]) / (near * step)
    begun = (acceleration > 0.0) & (way * velocity[starts] <= acceleration * near * step)  # else it began long before
    starts, way, fastest, acceleration = starts[begun], way[begun], fastest[begun], acceleration[begun]
    window = starts[:, None] + np.arange(-rest - beside, near + beside + 1)
    beyond = friction[window] * way[:, None] - starting.damping * np.maximum(velocity[window] * way[:, None], 0.0)
    at = starts - rest + beyond[:, beside:-beside].argmax(axis=1)
    damped = starting.damping * np.maximum(way * velocity[at], 0.0)
    peak = way * friction[at] - damped
    kept = peak - starting.constant * way >= starting.least
    curvature = _curvature(beyond[kept], step, beside)
    at, starts, way, fastest, acceleration = at[kept], starts[kept], way[kept], fastest[kept], acceleration[kept]
    rate = np.maximum(way * (friction[starts - before] - friction[starts - rest]) / ((rest - before) * step), 0.0)
    arm = run.drive.divisor[at]
    bias = _bias_of_peak(run, curvature * np.abs(arm), width)
    return Onsets(
        at, way, slowest, acceleration, fastest, rate, width, way * damped[kept], starting.damping, peak[kept],
        np.sign(arm) * way * bias, block_of(run, at), np.hypot(row_scale(run), starting.scatter * np.abs(arm)),
    )  # fmt: skip


def _curvature(beyond: Array, step: float, beside: int) -> float:
    """Return how sharp the peak of onsets is on the mean, minus its second derivative [N/s^2 or N m/s^2], not below 0.

    It is the harmonic mean of both its sides: what rises to a level and stays there has none.

    Args:
        beyond: What resists about each start, shape (k, m); its peak is sought but for so many samples at either end ...
        step: Time between two of them [s].
        beside: ... and so many to either side of it are asked.
    """
    if not beyond.size:
        return 0.0
    mean, square = beyond.mean(axis=0), (np.arange(1, beside + 1) * step) ** 2
    peak = beside + int(mean[beside:-beside].argmax())
    sides = [2.0 * float(square @ (mean[peak] - one)) / float(square @ square) for one in (
        mean[peak - beside : peak][::-1], mean[peak + 1 : peak + 1 + beside]
    )]  # fmt: skip
    return 2.0 * sides[0] * sides[1] / (sides[0] + sides[1]) if min(sides) > 0.0 else 0.0


def _bias_of_peak(run: MotionRun, curvature: Array, width: float) -> Array:
    """Return what noise adds to a peak on the mean [N or N m], shape of `curvature`.

    Where nothing is curved it is the mean of the largest value; a sharp peak lets noise move it, by its slope over the curvature, and adds
    half the square of that slope over it. What lies between is the harmonic sum of both. Twice the curvature that noise itself has at its
    largest values counts for nothing.

    Args:
        run: The balance, with its noise.
        curvature: Of the peak, by the mean over all onsets [N/s^2 or N m/s^2].
        width: Standard deviation of the filter [s].
    """
    accelerations = min(run.inertia.noise, run.noise) if run.inertia.has_mass else 0.0
    rest = math.sqrt(max(run.noise**2 - accelerations**2, 0.0))
    flat = math.hypot(LARGEST_ACCELERATION * accelerations, LARGEST * rest)
    slope = (STEEP_ACCELERATION * accelerations**2 + STEEP * rest**2) / width**2
    if slope <= 0.0 or not curvature.size:
        return np.zeros(curvature.shape)
    own = (STEEP_ACCELERATION * LARGEST_ACCELERATION * accelerations + STEEP * LARGEST * rest) / width**2 / math.sqrt(curvature.size)
    return np.asarray(flat * slope / (slope + 2.0 * np.maximum(curvature - 2.0 * own, 0.0) * flat))


def _starts(run: MotionRun, usable: NDArray[np.bool_], rest: int, moving: int) -> NDArray[np.int64]:
    """Return the first samples that move after so many at rest, and before so many that move on, shape (k,)."""
    velocity, n = run.kinematics.velocity, len(run.time)
    good = usable_samples(run, usable)
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
