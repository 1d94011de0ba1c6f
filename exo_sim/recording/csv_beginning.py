"""The beginning of a CSV file: its encoding, its delimiter, the line that names the columns, and what must not follow it."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from exo_sim.errors import RecordingError
from exo_sim.inputs import is_number
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import Selection, select

_DELIMITERS = (",", ";", "\t")
_SAMPLE = 1 << 18
_MOST_COLUMNS = 5000
UTF8 = "utf-8"
COMMAS = 'decimal commas; write decimal points, or hand in a column map with [file] decimal = ","'
#: Lines from the beginning in which column names are looked for below a preamble.
_PREAMBLE = 60
#: What ends a line for the parser of the rows; other characters that some programs take for line ends are part of a cell.
_LINE_END = re.compile(r"\r\n|\n|\r")
#: Those: tabulators and form feeds of old printers, separators, and the line ends of Unicode.
_NO_LINE_END = re.compile("[\x0b\x0c\x1c-\x1e\x85\u2028\u2029]")


@dataclass(frozen=True)
class Beginning:
    """What the first lines say: the headings and what is chosen of them, how many lines to skip, and those of the body."""

    headings: list[str]
    delimiter: str
    skip: int
    selection: Selection
    body: list[str]


def begin(path: Path, raw: bytes, encoding: str, column_map: ColumnMap | None) -> Beginning:
    """Return what the first lines of a file say; one that is too long by its size is refused."""
    sample = raw.decode(encoding, errors="ignore").removeprefix("\ufeff")  # of UTF-8, the sample may end within a character
    if not sample.strip():
        raise RecordingError(f'"{path}": the file is empty')
    lines = _LINE_END.split(sample)
    if not lines[-1]:
        lines.pop()
    above = column_map.skip if column_map else 0
    asked = f'skip = {above} of column map "{column_map.path}"' if column_map else ""
    named = (i for i, line in enumerate(lines) if i >= above and line.strip() and not line.lstrip().startswith("#"))
    skipped = next(named, None)
    if skipped is None and above:
        raise RecordingError(f'"{path}": {asked} leaves no line of the {len(lines)} there are')
    if skipped is None:
        raise RecordingError(f'"{path}": there are only comments in it; the first other line must name the columns')
    if skipped == len(lines) - 1 and (found := _NO_LINE_END.search(lines[skipped])):
        end = f"U+{ord(found[0]):04X}"
        raise RecordingError(f'"{path}": there is a heading and no row below it: {end} ends no line; end each with a line feed')
    decimal = column_map.decimal if column_map else "."
    among = [each for each in _DELIMITERS if each != decimal]
    delimiter = (column_map.delimiter if column_map else None) or max(among, key=lines[skipped].count)
    headings = _headings(path, lines[skipped], skipped, delimiter)
    if len(headings) == 1 and not (column_map and column_map.delimiter):
        _refuse_blanks(path, lines, skipped)
    if column_map and not column_map.header:
        headings = [str(number) for number in range(1, len(headings) + 1)]
        skipped -= 1
    elif all(is_number(cell) for cell in headings):
        raise RecordingError(
            f'"{path}": line {skipped + 1} holds numbers where the column names should be; add a line like '
            '"time [s],piston.pressure_1 [Pa]", or hand in a column map with header = false'
        )
    _refuse_preamble(path, headings, lines, skipped, delimiter, column_map)
    selection = select(str(path), headings, column_map)
    selection.refuse_if_too_long(str(path), _rows(path, lines, skipped))
    return Beginning(headings, delimiter, skipped + 1, selection, lines[skipped + 1 :])


def sample_of(path: Path) -> bytes:
    """Return the beginning of a file."""
    with path.open("rb") as file:
        raw = file.read(_SAMPLE)
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise RecordingError(f'"{path}": it is UTF-16 text; save it as UTF-8')
    if b"\0" in raw:
        raise RecordingError(f'"{path}": it is not text; name it by its kind: .csv, .parquet or .rrd')
    return raw


def encoding_of(pieces: Iterable[bytes], whole: bool = True) -> str:
    """Return what encoding the pieces of a text are in; where they are not the whole, they may end within a character."""
    decoder = codecs.getincrementaldecoder(UTF8)()
    try:
        for piece in pieces:
            decoder.decode(piece)
        decoder.decode(b"", final=whole)
    except UnicodeDecodeError:
        return "latin-1"
    return UTF8


def _headings(path: Path, line: str, skipped: int, delimiter: str) -> list[str]:
    try:
        headings = [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
    except csv.Error as error:
        raise RecordingError(f'"{path}": line {skipped + 1} cannot be read as column names: {error}') from None
    if len(headings) > _MOST_COLUMNS:
        raise RecordingError(f'"{path}": {len(headings)} columns; at most {_MOST_COLUMNS} are read: hand in those that matter')
    return headings


def _refuse_blanks(path: Path, lines: list[str], at: int) -> None:
    """Refuse a table whose cells are apart by blanks: a column's name holds one itself."""
    below = next((line.split() for line in lines[at + 1 :] if line.strip()), [])
    if len(below) > 1 and all(map(_is_numeric, below)):
        raise RecordingError(f'"{path}": line {at + 2} holds {len(below)} numbers with blanks between; write commas, semicolons or tabs')


def _refuse_preamble(
    path: Path, headings: list[str], lines: list[str], at: int, delimiter: str, column_map: ColumnMap | None
) -> None:
    """Refuse a first line with fewer cells than the rows below where a later line of words has as many: it says what to skip."""
    if column_map and not column_map.header:
        return
    rows = [(i, _cells(line, delimiter)) for i, line in enumerate(lines[:_PREAMBLE]) if i > at and line.strip()]
    first = next((i for i, cells in rows if sum(map(_is_numeric, cells)) > 1), None)
    if first is None:
        return
    width = len(_cells(lines[first], delimiter))
    between = [i for i, cells in rows if i < first and len(cells) == width and all(cells) and not any(map(_is_numeric, cells))]
    if len(headings) < width and between:
        raise RecordingError(
            f'"{path}": line {at + 1} has {len(headings)} cells, line {between[0] + 1} has {width} as the rows below have: the column '
            f"names? Hand in a column map with [file] skip = {between[0]}"
        )


def _cells(line: str, delimiter: str) -> list[str]:
    return [cell.strip() for cell in line.split(delimiter)]


def _is_numeric(cell: str) -> bool:
    return is_number(cell) or is_number(cell.replace(",", ".", 1))


def _rows(path: Path, lines: list[str], skipped: int) -> float:
    """Return about how many rows a file has, from the length of its first."""
    body = lines[skipped + 1 : -1] or lines[skipped + 1 :]
    if not body:
        raise RecordingError(f'"{path}": there is a heading and no row below it')
    return path.stat().st_size / max(1.0, sum(len(line) + 1 for line in body) / len(body))


def refuse_decimal_comma(path: Path, body: list[str], delimiter: str, width: int) -> None:
    for number, line in enumerate(body[:50], start=1):
        cells = line.split(delimiter)
        comma = next((cell for cell in cells if cell.count(",") == 1 and is_number(cell.replace(",", "."))), None)
        if delimiter != "," and comma is not None:
            where = f'"{path}": row {number} holds "{comma.strip()}"'
            raise RecordingError(f"{where}: {COMMAS}")
        if delimiter == "," and len(cells) == 2 * width and all(is_number(cell) for cell in cells):
            raise RecordingError(
                f'"{path}": row {number} has {len(cells)} cells under {width} column names: decimal commas? '
                "Write decimal points, or part the columns by semicolons"
            )
