"""The one table of signals that everything simulated or measured becomes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Recording:
    """Signals on one clock, in SI and radian.

    Attributes:
        name: What to call it in reports: the file's name without its ending.
        time: Seconds, strictly increasing, shape (n,). Need not be uniform.
        columns: `"<part>.<signal>"` to values, shape (n,); NaN where a sample is missing.
        units: `"<part>.<signal>"` to the SI unit of its values.
        metadata: What travels with it: rig text, scenario, versions, seed. All text.
        breaks: Times at which the clock was mended [s]: what comes from there on does not follow what was before, and no prediction runs
            across, as across a jump of the clock.

    Of a file name that is no UTF-8, the bytes stand as escapes in `name` and `metadata`: every format can hold those.
    """

    name: str
    time: NDArray[np.float64]
    columns: Mapping[str, NDArray[np.float64]]
    units: Mapping[str, str]
    metadata: Mapping[str, str] = field(default_factory=dict)
    breaks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", _unicode(self.name))
        object.__setattr__(self, "metadata", {key: _unicode(text) for key, text in self.metadata.items()})

    def __contains__(self, key: str) -> bool:
        return key in self.columns

    def __getitem__(self, key: str) -> NDArray[np.float64]:
        return self.columns[key]

    def get(self, key: str) -> NDArray[np.float64] | None:
        """Return a column, or None where it was not recorded."""
        return self.columns.get(key)

    @property
    def duration(self) -> float:
        """Seconds from the first sample to the last."""
        return float(self.time[-1] - self.time[0]) if len(self.time) else 0.0

    def parts(self) -> tuple[str, ...]:
        """Return the names before the dot, in the order of the columns."""
        return tuple(dict.fromkeys(key.split(".", 1)[0] for key in self.columns))

    def span(self, start: float, stop: float) -> Recording:
        """Return the samples with start <= time < stop, as a recording of its own."""
        keep = slice(*np.searchsorted(self.time, (start, stop)))
        return replace(self, time=self.time[keep], columns={key: values[keep] for key, values in self.columns.items()})

    def followed_by(self, other: Recording) -> Recording:
        """Return this and a later piece of it as one recording."""
        columns = {key: np.concatenate([values, other.columns[key]]) for key, values in self.columns.items()}
        return replace(self, time=np.concatenate([self.time, other.time]), columns=columns)

    def thinned(self, most: int) -> Recording:
        """Return every n-th sample, n as small as leaves no more than `most`; the recording itself where it is short enough."""
        every = -(-len(self.time) // most)
        if every <= 1:
            return self
        columns = {key: values[::every] for key, values in self.columns.items()}
        return replace(self, time=self.time[::every], columns=columns)


def _unicode(text: str) -> str:
    return text.encode("utf-8", "backslashreplace").decode()
