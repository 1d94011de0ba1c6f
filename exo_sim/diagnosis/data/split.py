"""The division of time: training data to choose and fit on, validation data to refute with, test data to report on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.validation import HELD_OUT_SHARE

#: By recording, spans (start, stop) of its time [s].
Spans = Mapping[str, tuple[tuple[float, float], ...]]


@dataclass(frozen=True)
class Split:
    """Spans of each recording that no parameter is fitted to; the rest is training data.

    Attributes:
        test: For the reported errors; it takes no part in choosing either.
        validation: May refute an effect, or speak for another division of the time; never for an effect.
    """

    test: Spans
    validation: Spans = field(default_factory=dict)

    def in_test(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples are test data, shape (n,)."""
        return _inside(self.test, recording, time)

    def in_training(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples are training data, shape (n,)."""
        return ~(self.in_test(recording, time) | _inside(self.validation, recording, time))

    def all_kept_as_test(self) -> Split:
        """Return the split whose test time is all that no parameter was fitted to, its validation time as well."""
        names = {**self.validation, **self.test}
        return Split({name: tuple(sorted((*self.validation.get(name, ()), *self.test.get(name, ())))) for name in names})

    def validation_as_test(self) -> Split:
        """Return the split with validation and test exchanged, the training data the same."""
        return Split(self.validation, self.test)


def _inside(spans: Spans, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
    inside = np.zeros(len(time), dtype=bool)
    for start, stop in spans.get(recording, ()):
        inside |= (time >= start) & (time <= stop)
    return inside


def split(times: Sequence[tuple[str, NDArray[np.float64]]], head: bool = False) -> Split:
    """Hold out the end of every recording: its last 15 % for the test, the 15 % before them for validation.

    Of every one, not some of them whole: a recording is often the only one at its pressure, load or amplitude, and what depends on that
    shows in no other.

    Args:
        times: Name and clock of every recording.
        head: Hold out the beginnings instead, the test first.
    """
    test, validation = {}, {}
    for name, time in times:
        start, stop = float(time[0]), float(time[-1])
        half = 0.5 * HELD_OUT_SHARE * (stop - start)
        test[name] = ((start, start + half) if head else (stop - half, stop),)
        validation[name] = ((start + half, start + 2.0 * half) if head else (stop - 2.0 * half, stop - half),)
    return Split(test, validation)
