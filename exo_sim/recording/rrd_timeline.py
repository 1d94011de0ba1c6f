"""The one timeline of an .rrd."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import rerun as rr


def clock(times: NDArray[np.float64]) -> rr.TimeColumn:
    """Return seconds as rerun's timeline `time`."""
    import rerun as rr

    return rr.TimeColumn("time", duration=np.rint(times * 1e9).astype("timedelta64[ns]"))
