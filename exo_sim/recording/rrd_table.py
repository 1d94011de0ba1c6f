"""Reading an .rrd: every entity that is named like a signal and holds scalars over time.

The one file that reads rerun's format; the format is promised to open only in the next minor version of rerun.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.recording import columns
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, Selection, select
from exo_sim.recording.columns import Column
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.one_clock import on_one_clock
from exo_sim.recording.rrd_messages import is_unfinished, whole_messages

if TYPE_CHECKING:
    import pyarrow as pa

_SCALARS = "Scalars:scalars"
_UNIT = "unit"
#: The leaf under which a signal's own values stand where a recording also overlays simulated ones.
RECORDED = "recorded"
#: Leaves that hold other than what was recorded.
OVERLAYS = ("before", "after", "simulated", "free_run")
_PROPERTIES = "__properties"
_PREFERRED_CLOCKS = ("time", "sim_time", "t", "log_time")


class _Entity:
    def __init__(self) -> None:
        self.clocks: dict[str, list[NDArray[np.float64]]] = {}
        self.values: list[NDArray[np.float64]] = []


def read_rrd(path: Path, column_map: ColumnMap | None = None, overlay: str = "") -> RawTable:
    """Read an .rrd. Entities `/piston/pressure_1`, `/piston.pressure_1` and `/piston/pressure_1/recorded` are the same.

    Args:
        path: The file.
        column_map: For foreign names.
        overlay: One of `OVERLAYS`: what was simulated instead, of the signals that have it; what was recorded when "".

    Raises:
        RecordingError: not a whole .rrd of a version that this rerun opens, no scalars, or what `select` refuses.
    """
    entities, units, metadata = _scan(path, overlay or RECORDED)
    if overlay and not entities:
        raise RecordingError(f'"{path}": holds no signal "{overlay}"; `exo-sim compare` and `exo-sim diagnose` write {", ".join(OVERLAYS)}')
    if not entities:
        raise RecordingError(f'"{path}": no entity in it holds scalars over time; is it a recording of signals?')
    headings = {_heading(name, units, column_map): name for name in entities}
    selection = select(str(path), [f"{columns.TIME} [s]", *headings], column_map and _with_time(column_map))
    findings = list(selection.findings)
    if is_unfinished(path):
        says = f'"{path.name}" was still being written; what is in it so far was read'
        findings.append(Finding(path.name, "unfinished", says, severity="warning", use="used"))
    findings += [_guessed(column) for column in selection.columns[1:] if _is_guessed(column, headings, units)]
    clock = _clock(path, entities)
    series = {}
    for column in selection.columns[1:]:
        entity = entities[headings[column.source]]
        times = np.concatenate(entity.clocks[clock]) if clock in entity.clocks else np.zeros(0)
        series[column.key] = times, column.to_si(np.concatenate(entity.values))
    time, values = on_one_clock(path, series, findings)
    selection.refuse_if_too_long(str(path), len(time))
    return RawTable(time, values, {c.key: c.unit for c in selection.columns}, findings, metadata)


def check_whole(path: Path) -> None:
    """Go through an .rrd to its end.

    Raises:
        RecordingError: it is not one, or not whole.
    """
    for _ in _chunks(path):
        pass


def _chunks(path: Path) -> Iterator[Any]:
    from rerun.chunk import RrdReader

    try:
        with warnings.catch_warnings(), whole_messages(path) as readable:
            warnings.simplefilter("ignore")  # what is wrong is said in our line
            yield from RrdReader(str(readable)).stream()
    except RecordingError:
        raise
    except Exception as error:  # rerun raises bare exceptions of many kinds
        why = str(error).splitlines()[0][:160] if str(error) else type(error).__name__
        says = f'"{path}": not a whole .rrd that this version of rerun opens ({why}); use the .parquet beside it'
        raise RecordingError(says) from None


def _scan(path: Path, leaf: str) -> tuple[dict[str, _Entity], dict[str, str], dict[str, str]]:
    entities: dict[str, _Entity] = {}
    units: dict[str, str] = {}
    metadata: dict[str, str] = {}
    rows = 0
    for chunk in _chunks(path):
        name = _name(chunk.entity_path, leaf)
        if name.startswith(_PROPERTIES):
            metadata.update(_texts(chunk))
            continue
        if chunk.is_static:
            units.update((name, text) for key, text in _texts(chunk).items() if key == _UNIT)
            continue
        batch = chunk.to_record_batch()
        if _SCALARS in batch.schema.names and _is_signal(chunk.entity_path, leaf):
            rows += batch.num_rows
            Selection((Column("", "", ""),)).refuse_if_too_long(str(path), rows)
            _take(entities.setdefault(name, _Entity()), batch)
    return entities, units, metadata


def _name(entity_path: str, leaf: str) -> str:
    return entity_path.lstrip("/").replace("\\", "").removesuffix("/" + leaf)


def _is_signal(entity_path: str, leaf: str) -> bool:
    if entity_path.startswith("/difference/"):
        return False
    last = entity_path.rsplit("/", 1)[-1]
    return last not in OVERLAYS if leaf == RECORDED else last == leaf


def _texts(chunk: Any) -> dict[str, str]:
    from pyarrow import types

    batch = chunk.to_record_batch()
    texts = {}
    for field, column in zip(batch.schema, batch.columns):
        if types.is_list(field.type) and types.is_string(field.type.value_type) and len(column) and column[0].is_valid:
            cells = column[0].as_py()
            if cells and not field.name.startswith("RecordingInfo:"):
                texts[field.name.rsplit(":", 1)[-1]] = cells[0]
    return texts


def _take(entity: _Entity, batch: pa.RecordBatch) -> None:
    import pyarrow as pa

    lists = batch.column(batch.schema.get_field_index(_SCALARS))
    first = np.asarray(lists.offsets)[:-1]
    present = np.diff(np.asarray(lists.offsets)) > 0
    if lists.null_count:
        present &= np.asarray(lists.is_valid())
    flat = lists.values.cast(pa.float64()).to_numpy(zero_copy_only=False)
    entity.values.append(np.array(flat[first[present]], dtype=np.float64))
    for field in batch.schema:
        meta = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
        if meta.get("rerun:kind") != "index":
            continue
        ticks = batch.column(batch.schema.get_field_index(field.name))
        numbers = ticks.cast(pa.int64()).to_numpy(zero_copy_only=False)[present]
        seconds = numbers / 1e9 if not pa.types.is_integer(field.type) else numbers.astype(float)
        entity.clocks.setdefault(meta.get("rerun:index_name", field.name), []).append(seconds)


def _heading(name: str, units: dict[str, str], column_map: ColumnMap | None) -> str:
    """Return the heading that an entity would have in a table."""
    if column_map and name in column_map.columns:
        return name
    plain, given = name, None
    if "[" in name:
        plain, given = columns.split(name)
    if "/" in plain and "." not in plain.rsplit("/", 1)[1]:
        plain = ".".join(plain.rsplit("/", 1))
    unit = given or units.get(name)
    if unit is None:
        try:
            unit = columns.signal_of(plain).units[0]
        except RecordingError:
            return plain
    return columns.heading(plain, unit)


def _with_time(column_map: ColumnMap) -> ColumnMap:
    kept = {name: column for name, column in column_map.columns.items() if column.key != columns.TIME}
    return ColumnMap(column_map.path, kept, column_map.header, column_map.delimiter)


def _is_guessed(column: Column, headings: dict[str, str], units: dict[str, str]) -> bool:
    name = headings.get(column.source, column.source)
    return name not in units and "[" not in name and column.unit != "1"


def _guessed(column: Column) -> Finding:
    says = f'"{column.key}" says no unit; "{column.unit}" was taken. Log a static component "unit" to be sure'
    return Finding(column.key, "unit", says, severity="info", use="used")


def _clock(path: Path, entities: dict[str, _Entity]) -> str:
    names = {name for entity in entities.values() for name in entity.clocks}
    if not names:
        raise RecordingError(f'"{path}": its scalars are on no timeline; log them over "time"')
    preferred = next((name for name in _PREFERRED_CLOCKS if name in names), None)
    return preferred or min(names - {"log_tick"} or names)
