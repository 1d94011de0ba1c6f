"""Which time may be used to choose and to fit, and which is kept for the proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Share of a lone recording that is kept for the proof: its end.
HELD_OUT_SHARE = 0.3


@dataclass(frozen=True)
class Split:
    """Spans (start, stop) of each recording that take no part in choosing or fitting."""

    spans: Mapping[str, tuple[tuple[float, float], ...]]

    def held_out(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples are kept for the proof, shape (n,)."""
        kept = np.zeros(len(time), dtype=bool)
        for start, stop in self.spans.get(recording, ()):
            kept |= (time >= start) & (time <= stop)
        return kept

    def training(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples may be used, shape (n,)."""
        return ~self.held_out(recording, time)


def split(times: Sequence[tuple[str, NDArray[np.float64]]], head: bool = False) -> Split:
    """Keep whole recordings where there are several (a quarter of them, the last), else the end of the only one.

    Args:
        times: Name and clock of every recording.
        head: Keep the first ones, or the beginning, instead.
    """
    if len(times) == 1:
        name, time = times[0]
        start, stop = float(time[0]), float(time[-1])
        share = HELD_OUT_SHARE * (stop - start)
        return Split({name: ((start, start + share) if head else (stop - share, stop),)})
    count = max(1, len(times) // 4)
    return Split({name: ((float(time[0]), float(time[-1])),) for name, time in (times[:count] if head else times[-count:])})
