"""Which time may be used to choose and to fit, which may speak against a name, and which is kept for the proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

#: Share of a lone recording that no number is fitted to: one half of it is the check, the other the proof.
HELD_OUT_SHARE = 0.3

Spans = Mapping[str, tuple[tuple[float, float], ...]]


@dataclass(frozen=True)
class Split:
    """Spans (start, stop) of each recording that no number is fitted to.

    Attributes:
        spans: The proof: takes no part in choosing either.
        check: May speak against a name that the rest gave, and for another division of the time; never for a name.
    """

    spans: Spans
    check: Spans = field(default_factory=dict)

    def held_out(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples are kept for the proof, shape (n,)."""
        return _inside(self.spans, recording, time)

    def training(self, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which samples may be fitted to, shape (n,)."""
        return ~(self.held_out(recording, time) | _inside(self.check, recording, time))

    def checking(self) -> Split:
        """Return the split whose check stands where the proof does."""
        return Split(self.check, self.spans)


def _inside(spans: Spans, recording: str, time: NDArray[np.float64]) -> NDArray[np.bool_]:
    inside = np.zeros(len(time), dtype=bool)
    for start, stop in spans.get(recording, ()):
        inside |= (time >= start) & (time <= stop)
    return inside


def split(times: Sequence[tuple[str, NDArray[np.float64]]], head: bool = False) -> Split:
    """Keep whole recordings where there are several (a quarter of them, one at least, the last), else the end of the only one.

    A lone recording's last 15 % are the proof, the 15 % before it the check; several recordings have no check.

    Args:
        times: Name and clock of every recording.
        head: Keep the beginning of a lone recording instead, the proof first.
    """
    if len(times) > 1:
        count = max(1, len(times) // 4)
        return Split({name: ((float(time[0]), float(time[-1])),) for name, time in times[-count:]})
    name, time = times[0]
    start, stop = float(time[0]), float(time[-1])
    half = 0.5 * HELD_OUT_SHARE * (stop - start)
    if head:
        return Split({name: ((start, start + half),)}, {name: ((start + half, start + 2.0 * half),)})
    return Split({name: ((stop - half, stop),)}, {name: ((stop - 2.0 * half, stop - half),)})
