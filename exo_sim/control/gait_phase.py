"""Where in the stride the wearer is, from the machine's own joint encoders.

An observer with the state (phase, cadence) predicts what the encoders show at its phase, from a table of a calibration walk, and
corrects both by what they do show: the extended Kalman filter of Thatte, Shah and Geyer (2019, "Robust and adaptive lower limb
prosthesis stance control via extended Kalman filter-based gait phase estimation", IEEE Robotics and Automation Letters 4(3):3129) with
gains that stay as they are. Its bandwidth is half a hertz: a stride that takes longer than the one before is followed, noise is not. Each
encoder's offset from the table is followed slowly, so that a hip that is always some degrees less flexed is no error of phase.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

#: Natural frequency of the observer [rad/s], its damping ratio, and the time in which an encoder's offset is followed [s].
_FREQUENCY, _DAMPING, _OFFSET = 2.0 * math.pi * 0.6, 0.9, 4.0
#: The cadence may leave that of the calibration by this factor, either way.
_RANGE = 1.5
#: Encoders that turn less than this over a stride say nothing of the phase, and the clock goes on [rad a cycle, rms].
_STILL = 0.05


class PhaseObserver:
    """Phase and cadence of a periodic motion.

    Args:
        table: What the encoders showed at evenly spaced phases of the calibration, shape (n, encoders).
        period: Of the calibration's strides [s].
    """

    def __init__(self, table: NDArray[np.float64], period: float) -> None:
        n = len(table)
        spectrum = np.fft.rfft(table, axis=0)
        rate = 2j * np.pi * np.arange(len(spectrum))[:, None]
        rate[-1] = 0.0
        slope = np.fft.irfft(rate * spectrum, n, axis=0)
        self._table = np.concatenate([table, table[:1]])
        turning = float(np.mean((slope**2).sum(axis=1)))
        self._slope = np.concatenate([slope, slope[:1]]) / turning if turning > _STILL**2 else np.zeros((n + 1, table.shape[1]))
        self._n, self._usual = n, 1.0 / period
        self.start(0.0)

    def start(self, phase: float) -> None:
        """Begin at a phase, with the calibration's cadence."""
        self.phase, self.cadence = phase, self._usual
        self._offset = np.zeros(self._table.shape[1])

    def step(self, shown: NDArray[np.float64], dt: float) -> float:
        """Take in what the encoders show [rad], shape (encoders,), a time after the last; return the phase, whole strides counted on."""
        self.phase += dt * self.cadence
        at = (self.phase % 1.0) * self._n
        i = min(int(at), self._n - 1)
        u = at - i
        off = shown - (1.0 - u) * self._table[i] - u * self._table[i + 1]
        slope = (1.0 - u) * self._slope[i] + u * self._slope[i + 1]
        late = float(slope @ (off - self._offset))
        self._offset += dt / _OFFSET * (off - self._offset)
        self.phase += dt * 2.0 * _DAMPING * _FREQUENCY * late
        cadence = self.cadence + dt * _FREQUENCY**2 * late
        self.cadence = min(max(cadence, self._usual / _RANGE), self._usual * _RANGE)
        return self.phase
