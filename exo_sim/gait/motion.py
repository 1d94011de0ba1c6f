"""A reference motion: one cycle of every coordinate with exact derivatives, repeated for as long as wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from exo_sim.machine.ground import Ground
from exo_sim.physics.compiled import kernel

#: Samples of one stride or repetition.
SAMPLES = 512


@dataclass(frozen=True)
class Motion:
    """One cycle of a prescribed motion, sampled at even phases, coordinates in the order of `machine.person.COORDINATES`.

    A cycle is one stride or repetition of n = SAMPLES samples, or a whole trial of so many for each stride.

    Attributes:
        period: Duration of a cycle [s].
        advance: How far the pelvis travels in a cycle [m].
        position: Coordinates without the steady advance and climb, shape (n, 9).
        slope, curvature: First and second derivative of the coordinates by phase, the steady advance and climb included in the
            slope.
        share: How much of the load the left and the right foot carry, shape (n, 2); rows sum to 1.
        pressure_centre: Where under each foot, ahead of the ankle along the sole [m], shape (n, 2).
        contact: Whether heel_l, toe_l, heel_r, toe_r are meant to touch the ground, shape (n, 4).
        support: How far the machine is to carry the load itself, 0 (the wearer sits) to 1, shape (n,).
        trial: What is known of the strides where a cycle is a whole trial, else None.
        ground: What is walked on.
        from_rest: Whether a cycle begins and ends at rest, with steps between.
    """

    period: float
    advance: float
    position: NDArray[np.float64]
    slope: NDArray[np.float64]
    curvature: NDArray[np.float64]
    share: NDArray[np.float64]
    pressure_centre: NDArray[np.float64]
    contact: NDArray[np.bool_]
    support: NDArray[np.float64]
    trial: WholeTrial | None = None
    ground: Ground = field(default_factory=Ground)
    from_rest: bool = False

    @property
    def climb(self) -> float:
        """How far the ground rises in a cycle [m]."""
        return self.ground.grade * self.advance

    @property
    def strides(self) -> int:
        """How many strides or repetitions a cycle has."""
        return 1 if self.trial is None else self.trial.strides

    @property
    def stride_time(self) -> float:
        """How long a stride or repetition takes, the mean over a cycle [s]."""
        return self.period / self.strides

    @property
    def phase(self) -> NDArray[np.float64]:
        """The phase of the right foot's stride at each sample, shape (n,); a whole trial counts its strides on."""
        return np.arange(len(self.position)) / len(self.position) if self.trial is None else self.trial.foot_phase[:, 1]

    def at(self, phase: NDArray[np.float64], first: int = 9) -> NDArray[np.float64]:
        """Return the first coordinates without the steady advance and climb at any phases [cycles], shape (n, first)."""
        grid = np.linspace(0.0, 1.0, len(self.position) + 1)
        closed, phase = np.concatenate([self.position[:, :first], self.position[:1, :first]]), phase % 1.0
        return np.stack([np.interp(phase, grid, column) for column in closed.T], axis=1)

    def tables(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return position and slope, the first row repeated behind the last, (n + 1, 9), for `reference`."""
        return (
            np.ascontiguousarray(np.concatenate([self.position, self.position[:1]])),
            np.ascontiguousarray(np.concatenate([self.slope, self.slope[:1]])),
        )

    def at_cadence(self, factor: float) -> Motion:
        """Return the same motion, `factor` times as fast."""
        trial = self.trial and replace(self.trial, mean=self.trial.mean.at_cadence(factor))
        return replace(self, period=self.period / factor, trial=trial)


@dataclass(frozen=True)
class WholeTrial:
    """The strides of a motion whose cycle is a whole trial.

    Attributes:
        strides: How many.
        mean: The mean stride, on which torques are planned and the trunk's lean is chosen.
        foot_phase: Phase of the left and of the right foot from its own heel strike, counted on from stride to stride, shape (n, 2).
    """

    strides: int
    mean: Motion
    foot_phase: NDArray[np.float64]

    def phase_at(self, cycles: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the phase of the right foot's stride, 0 to 1, at times in cycles of the trial, shape (n,)."""
        grid = np.arange(len(self.foot_phase) + 1) / len(self.foot_phase)
        closed = np.append(self.foot_phase[:, 1], self.foot_phase[0, 1] + self.strides)
        return np.asarray(np.interp(cycles % 1.0, grid, closed) % 1.0)

    def played(self, table: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return a table over the mean stride's phase at the phases of the trial: left leg's columns by the left foot.

        Args:
            table: Shape (SAMPLES + 1, 6), the first row repeated behind the last: left leg, right leg.

        Returns:
            Shape (n + 1, 6).
        """
        grid = np.linspace(0.0, 1.0, len(table))
        right = np.stack([self.foot_phase[:, 0] + 0.5] * 3 + [self.foot_phase[:, 1]] * 3, axis=1) % 1.0
        out = np.stack([np.interp(phase, grid, column) for phase, column in zip(right.T, table.T)], axis=1)
        return np.ascontiguousarray(np.concatenate([out, out[:1]]))

    def of_segments(self, table: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what belongs to the person's segments over the mean stride's phase at the phases of the trial, as `played`.

        Args:
            table: Shape (SAMPLES, 7, m): torso, left leg, right leg.

        Returns:
            Shape (n, 7, m).
        """
        left, right = (self.foot_phase[:, 0] + 0.5) % 1.0, self.foot_phase[:, 1] % 1.0
        grid = np.arange(len(table)) / len(table)
        out = np.empty((len(left), *table.shape[1:]))
        for segment, phase in enumerate([right, *[left] * 3, *[right] * 3]):
            for k in range(table.shape[2]):
                out[:, segment, k] = np.interp(phase, grid, table[:, segment, k], period=1.0)
        return out


def travelling(motion: Motion, position: NDArray[np.float64]) -> Motion:
    """Return a motion with other coordinates, shape (n, 9), over the same ground."""
    slope, curvature = derivatives(position)
    slope[:, 0] += motion.advance
    slope[:, 1] += motion.climb
    return replace(motion, position=position, slope=slope, curvature=curvature)


def derivatives(samples: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return first and second derivative by phase of smooth periodic samples, shape (n, ...), by Fourier series."""
    n = len(samples)
    spectrum = np.fft.rfft(samples, axis=0)
    rate = 2j * np.pi * np.arange(len(spectrum))
    if n % 2 == 0:
        rate[-1] = 0.0
    rate = rate.reshape(-1, *([1] * (samples.ndim - 1)))
    return np.fft.irfft(rate * spectrum, n, axis=0), np.fft.irfft(rate**2 * spectrum, n, axis=0)


def phases() -> NDArray[np.float64]:
    """Return the phases at which a cycle is sampled, shape (SAMPLES,)."""
    return np.arange(SAMPLES) / SAMPLES


def smooth(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rise from 0 at x <= 0 to 1 at x >= 1 with three continuous derivatives."""
    x = np.clip(x, 0.0, 1.0)
    return x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)


@kernel
def reference(
    cycles: float,
    period: float,
    advance: float,
    climb: float,
    position: NDArray[np.float64],
    slope: NDArray[np.float64],
    q: NDArray[np.float64],
    v: NDArray[np.float64],
) -> None:
    """Evaluate a motion by cubic Hermite interpolation of its tables.

    Args:
        cycles: Time since the start, in cycles.
        period, advance, climb: Of the motion.
        position, slope: `Motion.tables()`, shape (n + 1, 9).
        q, v: Written: coordinates and their rates, shape (9,).
    """
    n = position.shape[0] - 1
    whole = math.floor(cycles)
    at = (cycles - whole) * n
    i = min(int(at), n - 1)
    u = at - i
    h00, h10 = (1 + 2 * u) * (1 - u) ** 2, u * (1 - u) ** 2
    h01, h11 = u * u * (3 - 2 * u), u * u * (u - 1)
    d00, d10, d11 = 6 * u * (u - 1), (1 - u) * (1 - 3 * u), u * (3 * u - 2)
    step = 1.0 / n
    for j in range(position.shape[1]):
        a, b = position[i, j], position[i + 1, j]
        steady = advance if j == 0 else climb if j == 1 else 0.0
        sa, sb = (slope[i, j] - steady) * step, (slope[i + 1, j] - steady) * step
        q[j] = h00 * a + h10 * sa + h01 * b + h11 * sb + steady * cycles
        v[j] = ((d00 * (a - b) + d10 * sa + d11 * sb) * n + steady) / period


@kernel
def look_up(cycles: float, table: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """Interpolate a periodic table linearly.

    Args:
        cycles: Time in cycles.
        table: Values at evenly spaced phases, the first row repeated behind the last, shape (n + 1, m).
        out: Written, shape (m,).
    """
    n = table.shape[0] - 1
    at = (cycles - math.floor(cycles)) * n
    i = min(int(at), n - 1)
    u = at - i
    for j in range(table.shape[1]):
        out[j] = (1 - u) * table[i, j] + u * table[i + 1, j]
