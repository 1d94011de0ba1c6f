"""A time of a recording in words: with as many digits as tell its rows apart, however far its clock counts from nothing."""

from __future__ import annotations

import math

#: Digits of a time that is as long as its recording.
_DIGITS = 6
#: More are rounding, not time.
_MOST = 15


def instant(at: float, first: float, last: float) -> str:
    """Return a time [s] of a clock that goes from `first` to `last` [s].

    >>> instant(2.0, 0.0, 6.0), instant(1.7e9 + 0.25, 1.7e9, 1.7e9 + 6.0)
    ('2', '1700000000.25')
    """
    span, reach = abs(last - first), max(abs(first), abs(last))
    further = math.ceil(math.log10(reach / span)) if 0.0 < span < reach else 0
    return f"{at:.{min(_DIGITS + further, _MOST)}g}"
