"""LeRobot data sets (versions 2 and 3): Parquet files of frames, with `meta/info.json` that names the entries of their vectors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.inputs import json_value, text_of
from exo_sim.recording import columns
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, Selection, select
from exo_sim.recording.columns import Column

_MARKS = ("timestamp", "episode_index", "frame_index")
#: How many folders above a file `meta/info.json` may lie.
_ABOVE = 4
_MOST_ENTRIES = 256


def is_lerobot(names: list[str]) -> bool:
    """Return True for the columns of a LeRobot file."""
    return set(_MARKS) <= set(names)


def read_lerobot(path: Path, file: Any, column_map: ColumnMap | None = None) -> RawTable:
    """Read one episode.

    The clock is `timestamp`, in seconds. Entries of vectors are called `observation.state[knee_r]`, by the names in `meta/info.json`, or
    `observation.state[2]`; a column map says which is which. Of a file with several episodes the map's `[file] episode` names one.

    Args:
        path: The file, for messages.
        file: The open `pyarrow.parquet.ParquetFile`.
        column_map: Foreign names.

    Raises:
        RecordingError: several episodes and none named, an `info.json` that cannot be read, or what `select` refuses.
    """
    import pyarrow as pa

    Selection((Column("", "", ""),) * len(file.schema_arrow.names)).refuse_if_too_long(str(path), file.metadata.num_rows)
    names = _names(path)
    try:
        table = file.read()
        rows = _episode(path, np.asarray(table["episode_index"].to_numpy()), column_map)
        found: dict[str, NDArray[np.float64]] = {}
        for name in table.column_names:
            cells = table[name].combine_chunks()
            kind = cells.type
            if pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_boolean(kind):
                found[name] = cells.cast(pa.float64()).to_numpy(zero_copy_only=False)[rows]
            elif pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind):
                found |= {key: values[rows] for key, values in _entries(name, cells, names.get(name, [])).items()}
    except pa.ArrowException as error:
        raise RecordingError(f'"{path}": cannot be read: {str(error).splitlines()[0][:120]}; copy the file again') from None
    clock = column_map is not None and any(column.key == columns.TIME for column in column_map.columns.values())
    named = [(name if clock or name != "timestamp" else "time [s]", name) for name in found if name not in _MARKS[1:]]
    headings = dict(named)
    selection = select(str(path), [heading for heading, _ in named], column_map)
    values = {column.key: column.to_si(np.array(found[headings[column.source]])) for column in selection.columns}
    units = {column.key: column.unit for column in selection.columns}
    return RawTable(values.pop(columns.TIME), values, units, selection.findings)


def _episode(path: Path, index: NDArray[Any], column_map: ColumnMap | None) -> NDArray[np.bool_]:
    if index.dtype.kind not in "iu" or not len(index):
        raise RecordingError(f'"{path}": "episode_index" must hold a whole number in every row; export the data set again')
    there = np.unique(index)
    asked = column_map.episode if column_map else None
    if asked is None and len(there) > 1:
        raise RecordingError(
            f'"{path}": it holds {len(there)} episodes, {there[0]} to {there[-1]}; name one in a column map: [file] episode = {there[0]}'
        )
    if asked is not None and asked not in there:
        raise RecordingError(f'"{path}": there is no episode {asked}; there are {there[0]} to {there[-1]}')
    return index == (there[0] if asked is None else asked)


def _entries(name: str, cells: Any, names: list[str]) -> dict[str, NDArray[np.float64]]:
    """Return the entries of vectors as columns, where all of them are as long and numbers."""
    import pyarrow as pa

    lengths = cells.value_lengths() if not pa.types.is_fixed_size_list(cells.type) else None
    width = cells.type.list_size if lengths is None else (lengths[0].as_py() or 0) if len(lengths) else 0
    flat = cells.flatten()
    if not 0 < width <= _MOST_ENTRIES or len(flat) != width * len(cells) or not (
        pa.types.is_floating(flat.type) or pa.types.is_integer(flat.type)
    ):
        return {}
    table = flat.cast(pa.float64()).to_numpy(zero_copy_only=False).reshape(-1, width)
    called = names if len(names) == len(set(names)) == width else [str(i) for i in range(width)]
    return {f"{name}[{each}]": table[:, i] for i, each in enumerate(called)}


def _names(path: Path) -> dict[str, list[str]]:
    """Return the names of the entries of each feature, as `meta/info.json` above the file has them; nothing where there is none."""
    for folder in list(path.resolve().parents)[:_ABOVE]:
        info = folder / "meta" / "info.json"
        if not info.is_file():
            continue
        try:
            features = json_value(text_of(info))["features"]
            return {key: _flat(one.get("names")) for key, one in features.items() if isinstance(one, dict)}
        except (ValueError, KeyError, TypeError, AttributeError, OSError) as error:
            raise RecordingError(f'"{info}": is not the info.json of a LeRobot data set ({type(error).__name__})') from None
    return {}


def _flat(names: Any) -> list[str]:
    """Return names from a list, or from a dictionary of lists by kind ("motors")."""
    if isinstance(names, dict):
        return [str(each) for group in names.values() for each in (group if isinstance(group, list) else [group])]
    return [str(each) for each in names] if isinstance(names, list) else []
