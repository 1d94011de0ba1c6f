"""A wearer whose strides are not the mean stride: they take longer or shorter, left and right differ, the trunk leans.

Time is warped, not posture: each step takes its own time, and the body goes through the mean stride's postures in it, so that feet stay
where they were put. The time of a healthy adult's stride varies by 1 to 3 % from one to the next (coefficient of variation; Hausdorff
2005, "Gait variability: methods, modeling and meaning", Journal of NeuroEngineering and Rehabilitation 2:19).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from exo_sim.errors import ScenarioError
from exo_sim.gait.motion import SAMPLES, Motion, WholeTrial, derivatives
from exo_sim.machine.person import LEG_START

#: A varied motion of more strides than this repeats itself.
MOST_STRIDES = 64
#: Most that is taken: coefficient of variation, share of the stride, lean [rad].
_MOST_TIME, _MOST_ASYMMETRY, _MOST_LEAN = 0.08, 0.2, math.radians(15.0)
#: Harmonics of a stride that are kept when it is warped.
_HARMONICS = 30
_FINE = 16


@dataclass(frozen=True)
class Variation:
    """How strides differ from the mean stride.

    Attributes:
        stride_time: Standard deviation of the stride's time over its mean.
        asymmetry: Time of the right foot's step more than the left's, over the stride's; 0 where both are alike.
        lean: Of the trunk, forward, more than the motion's [rad]: the hips are flexed by as much more.
        seed: Where chance starts.

    Raises:
        ScenarioError: more of it than anybody walks with.
    """

    stride_time: float = 0.0
    asymmetry: float = 0.0
    lean: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0.0 <= self.stride_time <= _MOST_TIME:
            raise ScenarioError(f"variation: stride_time = {self.stride_time:g}: write 0 to {_MOST_TIME:g} of the stride's time")
        if abs(self.asymmetry) > _MOST_ASYMMETRY:
            most = f"{_MOST_ASYMMETRY:g}"
            raise ScenarioError(f"variation: asymmetry = {self.asymmetry:g}: write -{most} to {most} of the stride's time")
        if abs(self.lean) > _MOST_LEAN:
            most = f"{math.degrees(_MOST_LEAN):g} deg"
            raise ScenarioError(f"variation: lean = {math.degrees(self.lean):g} deg: write -{most} to {most}")

    def applied(self, motion: Motion, strides: int) -> Motion:
        """Return the motion of one stride as one of several, at most `MOST_STRIDES`; of one where all are alike."""
        leant = self._leant(motion)
        if self.stride_time == 0.0 and self.asymmetry == 0.0:
            return leant
        from scipy.interpolate import CubicSpline  # half of what `exo-sim size --quick` takes to start

        count = min(strides, MOST_STRIDES) if self.stride_time else 1
        steps = np.full(2 * count, 0.5) + 0.5 * self.asymmetry * np.tile([1.0, -1.0], count)
        # a stride is two steps, so that its time varies by less than theirs
        steps *= 1.0 + math.sqrt(2.0) * self.stride_time * np.random.default_rng(self.seed).standard_normal(len(steps))
        steps *= count / steps.sum()
        ends = np.concatenate([[0.0], np.cumsum(steps)])
        away = 0.5 * np.arange(len(ends)) - ends
        away[-1] = away[0]
        off = CubicSpline(ends, away, bc_type="periodic")
        clock = np.arange(count * SAMPLES) / SAMPLES
        return _warped(leant, clock + off(clock), clock, count)

    def _leant(self, motion: Motion) -> Motion:
        position = motion.position.copy()
        position[:, 2] -= self.lean
        for start in LEG_START.values():
            position[:, start] += self.lean
        return replace(motion, position=position)


def _warped(motion: Motion, phase: np.ndarray, clock: np.ndarray, count: int) -> Motion:
    """Return a motion that is at a phase [cycles] when a clock [cycles] says so, both of `count` cycles from 0."""
    spectrum = np.fft.rfft(motion.position, axis=0)
    spectrum[_HARMONICS + 1 :] = 0.0
    fine = np.fft.irfft(spectrum, _FINE * SAMPLES, axis=0) * _FINE
    grid = np.arange(len(fine) + 1) / len(fine)
    closed = np.concatenate([fine, fine[:1]])
    position = np.stack([np.interp(phase % 1.0, grid, column) for column in closed.T], axis=1)
    position[:, 0] += motion.advance * (phase - clock)
    kept = np.fft.rfft(position, axis=0)
    kept[2 * _HARMONICS * count + 1 :] = 0.0  # what interpolation left
    position = np.fft.irfft(kept, len(position), axis=0)
    slope, curvature = derivatives(position)
    slope[:, 0] += count * motion.advance
    at = (phase % 1.0) * SAMPLES
    low, part = at.astype(int) % SAMPLES, (at % 1.0)[:, None]

    def between(table: np.ndarray) -> np.ndarray:
        return np.asarray((1.0 - part) * table[low] + part * table[(low + 1) % SAMPLES])

    return Motion(
        period=count * motion.period, advance=count * motion.advance, position=position, slope=slope, curvature=curvature,
        share=between(motion.share), pressure_centre=between(motion.pressure_centre),
        contact=motion.contact[np.rint(at).astype(int) % SAMPLES], support=between(motion.support[:, None])[:, 0],
        trial=WholeTrial(count, motion, np.stack([phase - 0.5, phase], axis=1)),
    )  # fmt: skip
