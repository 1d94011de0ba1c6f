"""Parquet, column by column, so that no more than the signals asked for are ever in memory."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError, printable
from exo_sim.recording import arrow_without_pandas
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, select
from exo_sim.recording.columns import TIME, Column
from exo_sim.recording.lerobot_table import is_lerobot, read_lerobot

if TYPE_CHECKING:
    import pyarrow as pa

_NOT_OURS = (b"pandas", b"ARROW:schema")


def read_parquet(path: Path, column_map: ColumnMap | None = None) -> RawTable:
    """Read a Parquet file.

    Raises:
        RecordingError: cut off or not Parquet, no rows, a column that holds no numbers, or what `select` refuses.
    """
    import pyarrow as pa
    from pyarrow import parquet

    arrow_without_pandas.settle()
    try:
        name_is_text = printable(path.name) == path.name
        file = parquet.ParquetFile(path if name_is_text else path.open("rb"))
    except (pa.ArrowException, OSError) as error:
        raise RecordingError(
            f'"{path}": not a whole Parquet file ({_first_line(error)}): '
            "copied in part, or still being written? Copy it again"
        ) from None
    with file:
        if is_lerobot(file.schema_arrow.names):
            return read_lerobot(path, file, column_map)
        selection = select(str(path), list(file.schema_arrow.names), column_map)
        rows = file.metadata.num_rows
        if not rows:
            raise RecordingError(f'"{path}": there are columns and no row in them')
        selection.refuse_if_too_long(str(path), rows)
        values = {column.key: _numbers(path, file, column) for column in selection.columns}
        text = file.schema_arrow.metadata or {}
    metadata = {key.decode(errors="replace"): value.decode(errors="replace") for key, value in text.items() if key not in _NOT_OURS}
    units = {column.key: column.unit for column in selection.columns}
    return RawTable(values.pop(selection.columns[0].key), values, units, list(selection.findings), metadata)


def _numbers(path: Path, file: object, column: Column) -> NDArray[np.float64]:
    import pyarrow as pa
    from pyarrow import compute as pc
    from pyarrow import types

    try:
        cells = file.read(columns=[column.source]).column(0)  # type: ignore[attr-defined]
    except (pa.ArrowException, OSError) as error:
        where = f'"{path}": column "{column.source}"'
        raise RecordingError(f"{where} cannot be read: {_first_line(error)}; copy the file again") from None
    if types.is_duration(cells.type):
        cells, column = cells.cast(pa.int64()), _in_seconds(column, cells.type.unit)
    elif types.is_timestamp(cells.type) and column.key == TIME and cells.null_count < len(cells):  # in whole ticks: sums would round
        ticks = cells.cast(pa.int64())
        cells, column = pc.subtract(ticks, pc.min(ticks)), _in_seconds(column, cells.type.unit)
    try:
        numbers = _array(cells.cast(pa.float64(), safe=False))
    except pa.ArrowException:
        raise RecordingError(f'"{path}": column "{column.source}" holds {cells.type}; it must hold numbers') from None
    return column.to_si(numbers)


def _array(cells: pa.ChunkedArray) -> NDArray[np.float64]:
    """Return the numbers of a column as an array of its own, shape (n,), NaN where one lacks: what pyarrow holds of it can go."""
    found, begin = np.empty(len(cells)), 0
    for chunk in cells.chunks:
        found[begin : begin + len(chunk)] = chunk.to_numpy(zero_copy_only=False)
        begin += len(chunk)
    return found


def _in_seconds(column: Column, unit: str) -> Column:
    return Column(column.source, column.key, "s", {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit])


def _first_line(error: BaseException) -> str:
    return str(error).splitlines()[0][:120] if str(error) else type(error).__name__
