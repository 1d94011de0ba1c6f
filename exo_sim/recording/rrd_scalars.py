"""Scalars over time, and how their lines look, as the Arrow arrays that rerun keeps.

What rerun makes of numbers, tuples and lists in Python costs more than all else of a column: it counts how many values each row has, and
copies them twice. Handed arrays of its own types it takes them as they are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyarrow as pa
    import rerun as rr


def column(values: NDArray[np.float64]) -> list[rr.ComponentColumn]:
    """Return values, shape (n,), as a column of scalars, one a row: what `rr.Scalars.columns(scalars=values)` is."""
    import pyarrow as pa
    import rerun as rr

    batch = rr.components.ScalarBatch(pa.array(np.ascontiguousarray(values, dtype=np.float64)))
    return [rr.ComponentColumn(rr.Scalars.descriptor_scalars(), batch)]


def colour(parts: tuple[int, ...]) -> pa.Array:
    """Return red, green, blue and perhaps opacity, 0 to 255, as the one number that rerun keeps."""
    import pyarrow as pa

    return pa.array([int.from_bytes(bytes((*parts, 255)[:4]), "big")], pa.uint32())


def width(points: float) -> pa.Array:
    """Return the width of a line."""
    import pyarrow as pa

    return pa.array([points], pa.float32())
