"""The little of recordings and rigs that a rival reads: it shares no reader with what it is held against."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_UNITS = {"mm": 1e-3, "m": 1.0, "cm^3": 1e-6, "mm^2": 1e-6, "bar": 1e5, "Pa": 1.0, "K": 1.0}


def si(text: str | float) -> float:
    """Return a quantity of a rig file in SI."""
    if isinstance(text, int | float):
        return float(text)
    value, _, unit = text.partition(" ")
    return float(value) * _UNITS.get(unit, 1.0)


def read(path: Path) -> dict[str, Array]:
    """Return the columns of a recording by name, units left out."""
    if path.suffix == ".parquet":
        import pyarrow.parquet as pq

        table = pq.read_table(path)
        return {name.split(" [")[0]: table[name].to_numpy() for name in table.column_names}
    with path.open() as lines:
        names = [name.split(" [")[0] for name in lines.readline().strip().split(",")]
    values = np.genfromtxt(path, delimiter=",", skip_header=1)
    return {name: values[:, i] for i, name in enumerate(names)}
