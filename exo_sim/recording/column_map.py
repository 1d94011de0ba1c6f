"""A column map: which foreign column is which signal.

A TOML file::

    [file]                       # optional, for CSV
    header = false               # the columns are then called "1", "2", ...
    delimiter = ";"
    decimal = ","                # decimal commas
    skip = 3                     # lines above the column names
    episode = 3                  # of a LeRobot file with several

    [columns]                    # foreign name = contract name, with the unit the foreign numbers are in; left out where all names fit
    "t(ms)"  = "time [ms]"
    "Pos"    = "slide.position [in]"
    "P1"     = { column = "piston.pressure_1 [bar]", scale = 1.0, offset = 1.01325 }   # gauge to absolute

`scale` and `offset` apply to the foreign number, in the unit given: `value * scale + offset`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from exo_sim import units
from exo_sim.errors import RecordingError, UnitError, nearest
from exo_sim.inputs import refusing, text_of, toml
from exo_sim.recording import columns
from exo_sim.recording.columns import Column

#: Lines above the column names that may be skipped: they must lie in the beginning of the file that is looked at.
MOST_SKIPPED = 1000


@dataclass(frozen=True)
class ColumnMap:
    """Foreign names to signals.

    Attributes:
        path: The file it was read from.
        columns: Foreign name to where it goes.
        header: False where a CSV has no heading line; its columns are called "1", "2", ...
        delimiter: What stands between the numbers of a CSV; found out where it is None.
        decimal: "." or ",": what stands before the decimals in a CSV.
        skip: How many lines of a CSV stand above the column names.
        episode: Which episode of a file with several; None for the only one.
    """

    path: Path
    columns: Mapping[str, Column] = field(default_factory=dict)
    header: bool = True
    delimiter: str | None = None
    episode: int | None = None
    decimal: str = "."
    skip: int = 0


def read_column_map(path: str | Path) -> ColumnMap:
    """Read a column map.

    Raises:
        RecordingError: the file is missing or not TOML, a key is unknown, or a name or unit cannot be.
    """
    path = Path(path)
    with refusing(lambda says: RecordingError(f'column map "{path}": {says}')):
        tables = toml(text_of(path))
    return column_map_of(tables, path)


def column_map_of(tables: Mapping[str, Any], path: Path) -> ColumnMap:
    """Return the column map that the tables of a TOML file, or of the same form, hold; `path` is what errors name.

    Raises:
        RecordingError: as `read_column_map`.
    """
    _known(path, "table", tables, ("file", "columns"))
    options, entries = tables.get("file", {}), tables.get("columns", {})
    if not isinstance(options, dict):
        raise RecordingError(f'column map "{path}": [file] must be a table')
    if not isinstance(entries, dict) or not (entries or options):
        raise RecordingError(f'column map "{path}": no [columns]; write lines like "P1" = "piston.pressure_1 [bar]"')
    _known(path, "key of [file]", options, ("header", "delimiter", "decimal", "skip", "episode"))
    header, delimiter = options.get("header", True), options.get("delimiter")
    if not isinstance(header, bool):
        raise RecordingError(f'column map "{path}": header = {header!r}; write true or false')
    if delimiter is not None and (not isinstance(delimiter, str) or len(delimiter) != 1):
        raise RecordingError(f'column map "{path}": delimiter = {delimiter!r}; write one character, like ";"')
    episode = options.get("episode")
    if episode is not None and (isinstance(episode, bool) or not isinstance(episode, int)):
        raise RecordingError(f'column map "{path}": episode = {episode!r}; write a number, like 3')
    decimal, skip = options.get("decimal", "."), options.get("skip", 0)
    if decimal not in (".", ",") or decimal == delimiter:
        raise RecordingError(f'column map "{path}": decimal = {decimal!r}; write "," or ".", not the delimiter')
    if isinstance(skip, bool) or not isinstance(skip, int) or not 0 <= skip <= MOST_SKIPPED:
        raise RecordingError(f'column map "{path}": skip = {skip!r}; write how many lines stand above the names, 0 to {MOST_SKIPPED}')
    read = {name: _entry(path, name, entry) for name, entry in entries.items()}
    return ColumnMap(path, read, header, delimiter, episode, decimal, skip)


def _known(path: Path, what: str, table: Mapping[str, object], choices: tuple[str, ...]) -> None:
    for key in table:
        if key not in choices:
            raise RecordingError(f'column map "{path}": unknown {what} "{key}"{nearest(key, choices)}')


def _entry(path: Path, name: str, entry: object) -> Column:
    return column_of(f'column map "{path}", "{name}"', name, entry)


def column_of(where: str, name: str, entry: object) -> Column:
    """Return the column that one line of a map says: a heading of the contract, or a table with `column`, `scale` and `offset`.

    Raises:
        RecordingError, UnitError: it is neither; `where` begins the message.
    """
    scale, offset = 1.0, 0.0
    heading = entry
    if isinstance(entry, dict):
        for key in entry:
            if key not in ("column", "scale", "offset"):
                raise RecordingError(f'{where}: unknown key "{key}"{nearest(key, ("column", "scale", "offset"))}')
        heading = entry.get("column")
        scale, offset = (_factor(where, key, entry.get(key, usual)) for key, usual in (("scale", 1.0), ("offset", 0.0)))
    if not isinstance(heading, str):
        raise RecordingError(f'{where}: write the column it is, like "piston.pressure_1 [bar]"')
    try:
        column = columns.resolve(heading)
    except (RecordingError, UnitError) as error:
        raise type(error)(f"{where}: {error}") from None
    return Column(name, column.key, column.unit, scale * column.scale, offset * column.scale + column.offset)


def _factor(where: str, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < units.LARGEST or (key == "scale" and value == 0):
        shown = f"{value!r}"[:40]
        raise RecordingError(f"{where}: {key} = {shown}: scale and offset must be numbers of less than {units.LARGEST:g}, the scale not 0")
    return float(value)
