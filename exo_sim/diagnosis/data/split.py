"""The division of time: training data to choose and fit on, validation data to refute with, test data to report on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim.diagnosis.policy.validation import HELD_OUT_SHARE, TEST_SHARE

#: By recording, spans (start, stop) of its time [s].
Spans = Mapping[str, tuple[tuple[float, float], ...]]


@dataclass(frozen=True)
class Split:
    """Spans of each recording that no parameter is fitted to; the rest is training data.

    Attributes:
        test: For the reported errors; it takes no part in choosing either. All that it may add is that something acts in it which the rest
            of the time never met.
        validation: Decides which of the names that were found stand, how much of the improved rig is written, and whether another division
            of the time is better.
    """

    test: Spans
    validation: Spans = field(default_factory=dict)

    def in_test(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples are test data, shape (n,)."""
        return _inside(self.test, recording, time)

    def in_training(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples are training data, shape (n,)."""
        return ~(self.in_test(recording, time) | _inside(self.validation, recording, time))

    def validation_as_test(self) -> Split:
        """Return the split with validation and test exchanged, the training data the same."""
        return Split(self.validation, self.test)

    def deciding(self) -> Split:
        """Return the split whose test time is what decides: the validation time, or the test time where there is no other."""
        return self.validation_as_test() if self.validation else self

    def kept_back(self) -> Split:
        """Return the split with validation and test time together as the test, the training data the same."""
        names = dict.fromkeys((*self.validation, *self.test))
        return Split({name: (*self.validation.get(name, ()), *self.test.get(name, ())) for name in names})


def _inside(spans: Spans, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
    inside = np.zeros(len(time), dtype=bool)
    for start, stop in spans.get(recording, ()):
        inside |= (time >= start) & (time <= stop)
    return inside


def split(times: Sequence[tuple[str, NDArray[np.float64]]], head: bool = False) -> Split:
    """Hold out the end of every recording: its last tenth for the test, the fifth before that for validation.

    Of every one, not some of them whole: a recording is often the only one at its pressure, load or amplitude, and what depends on that
    shows in no other.

    Args:
        times: Name and clock of every recording.
        head: Hold out the beginnings instead, the test first.
    """
    test, validation = {}, {}
    for name, time in times:
        start, stop = float(time[0]), float(time[-1])
        kept = HELD_OUT_SHARE * (stop - start)
        last = TEST_SHARE * kept
        test[name] = ((start, start + last) if head else (stop - last, stop),)
        validation[name] = ((start + last, start + kept) if head else (stop - kept, stop - last),)
    return Split(test, validation)
