"""Periodic functions of the gait phase as Fourier series, with exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Series:
    """f(phase) = mean + sum over h of cosine[h-1] cos(2 pi h phase) + sine[h-1] sin(2 pi h phase), one cycle a unit.

    Attributes:
        mean: The constant term.
        cosine, sine: One number a harmonic, shape (harmonics,).
    """

    mean: float
    cosine: NDArray[np.float64]
    sine: NDArray[np.float64]

    def __call__(self, phase: ArrayLike, derivative: int = 0) -> NDArray[np.float64]:
        """Evaluate the series or its first or second derivative by phase.

        Args:
            phase: Any shape, in cycles.
            derivative: 0, 1 or 2.
        """
        harmonic = np.arange(1, len(self.cosine) + 1)
        rate = 2 * np.pi * harmonic
        angle = np.asarray(phase, dtype=float)[..., None] * rate
        c, s = np.cos(angle), np.sin(angle)
        if derivative == 0:
            return self.mean + c @ self.cosine + s @ self.sine
        if derivative == 1:
            return -s @ (self.cosine * rate) + c @ (self.sine * rate)
        if derivative == 2:
            return -c @ (self.cosine * rate**2) - s @ (self.sine * rate**2)
        raise ValueError(f"derivative {derivative}: 0, 1 or 2")

    def integral(self) -> Series:
        """Return the integral over phase of the series without its mean, itself without a mean."""
        rate = 2 * np.pi * np.arange(1, len(self.cosine) + 1)
        return Series(0.0, -self.sine / rate, self.cosine / rate)

    def shifted(self, mean: float) -> Series:
        """Return the same series about another mean."""
        return Series(mean, self.cosine, self.sine)


def fit(values: ArrayLike, harmonics: int) -> Series:
    """Fit a series to one cycle sampled evenly, the end point left out.

    Args:
        values: Shape (n,), at phases i/n; n above twice the number of harmonics.
        harmonics: How many to keep.
    """
    spectrum = np.fft.rfft(np.asarray(values, dtype=float)) / len(np.asarray(values))
    if len(spectrum) <= harmonics:
        raise ValueError(f"{harmonics} harmonics need more than {2 * harmonics} samples a cycle")
    return Series(float(spectrum[0].real), 2 * spectrum[1 : harmonics + 1].real, -2 * spectrum[1 : harmonics + 1].imag)
