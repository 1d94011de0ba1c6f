"""CSV: any of the usual delimiters, a byte-order mark, comments, blank and torn lines, words among the numbers."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.inputs import is_number
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, Selection, select
from exo_sim.recording.data_quality_finding import Finding

if TYPE_CHECKING:
    import pyarrow as pa

_DELIMITERS = (",", ";", "\t")
_MISSING = ["", "nan", "NaN", "NAN", "-nan", "NA", "N/A", "null", "NULL", "None", "#N/A"]
#: Lines with another number of cells are dropped and said, up to this share of the rows; beyond it the file is refused.
_MOST_TORN = 0.01
_SAMPLE = 1 << 18
_MOST_COLUMNS = 5000
_UTF8 = "utf-8"
_COMMAS = 'decimal commas; write decimal points, or hand in a column map with [file] decimal = ","'
#: Lines from the beginning in which column names are looked for below a preamble.
_PREAMBLE = 60
#: Time of day as logs write it.
_CLOCK_TEXT = re.compile(r"(?:\d{4}-\d\d-\d\d[T ])?\d{1,2}:\d\d(?::\d\d(?:[.,]\d+)?)?$")
#: What ends a line for the parser of the rows; other characters that some programs take for line ends are part of a cell.
_LINE_END = re.compile(r"\r\n|\n|\r")
#: Those: tabulators and form feeds of old printers, separators, and the line ends of Unicode.
_NO_LINE_END = re.compile("[\x0b\x0c\x1c-\x1e\x85\u2028\u2029]")


def read_csv(path: Path, column_map: ColumnMap | None = None) -> RawTable:
    """Read a CSV file.

    Raises:
        RecordingError: not text, no heading, no rows, decimal commas, too many torn lines, or what `select` refuses.
    """
    raw = _sample(path)
    encoding = _encoding([raw], whole=False)
    begun = _begin(path, raw, encoding, column_map)
    with path.open("rb") as file:  # only now: what is too long is not read to its end
        whole = _encoding(iter(lambda: file.read(1 << 24), b""))
    if whole != encoding:
        encoding, begun = whole, _begin(path, raw, whole, column_map)
    decimal = column_map.decimal if column_map else "."
    if decimal == ".":
        _refuse_decimal_comma(path, begun.body, begun.delimiter, len(begun.headings))
    if encoding != _UTF8:
        says = f'"{path.name}" is not UTF-8 text; it was read as {encoding}, in which every byte is a character'
        begun.selection.findings.append(Finding(path.name, "encoding", says, severity="info", use="repaired"))
    return _Parse(path, begun.headings, begun.skip, begun.delimiter, begun.selection, encoding, decimal).table()


@dataclass(frozen=True)
class _Beginning:
    """What the first lines say: the headings and what is chosen of them, how many lines to skip, and those of the body."""

    headings: list[str]
    delimiter: str
    skip: int
    selection: Selection
    body: list[str]


def _begin(path: Path, raw: bytes, encoding: str, column_map: ColumnMap | None) -> _Beginning:
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
    selection.refuse_if_too_long(str(path), _rows(path, sample, lines, skipped))
    return _Beginning(headings, delimiter, skipped + 1, selection, lines[skipped + 1 :])


def _sample(path: Path) -> bytes:
    """Return the beginning of a file."""
    with path.open("rb") as file:
        raw = file.read(_SAMPLE)
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise RecordingError(f'"{path}": it is UTF-16 text; save it as UTF-8')
    if b"\0" in raw:
        raise RecordingError(f'"{path}": it is not text; name it by its kind: .csv, .parquet or .rrd')
    return raw


def _encoding(pieces: Iterable[bytes], whole: bool = True) -> str:
    """Return what encoding the pieces of a text are in; where they are not the whole, they may end within a character."""
    decoder = codecs.getincrementaldecoder(_UTF8)()
    try:
        for piece in pieces:
            decoder.decode(piece)
        decoder.decode(b"", final=whole)
    except UnicodeDecodeError:
        return "latin-1"
    return _UTF8


def _headings(path: Path, line: str, skipped: int, delimiter: str) -> list[str]:
    try:
        headings = [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
    except csv.Error as error:
        raise RecordingError(f'"{path}": line {skipped + 1} cannot be read as column names: {error}') from None
    if len(headings) > _MOST_COLUMNS:
        raise RecordingError(f'"{path}": {len(headings)} columns; at most {_MOST_COLUMNS} are read: hand in those that matter')
    return headings


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


def _rows(path: Path, sample: str, lines: list[str], skipped: int) -> float:
    body = lines[skipped + 1 : -1] or lines[skipped + 1 :]
    if not body:
        raise RecordingError(f'"{path}": there is a heading and no row below it')
    return path.stat().st_size / max(1.0, sum(len(line) + 1 for line in body) / len(body))


def _refuse_decimal_comma(path: Path, body: list[str], delimiter: str, width: int) -> None:
    for number, line in enumerate(body[:50], start=1):
        cells = line.split(delimiter)
        comma = next((cell for cell in cells if cell.count(",") == 1 and is_number(cell.replace(",", "."))), None)
        if delimiter != "," and comma is not None:
            where = f'"{path}": row {number} holds "{comma.strip()}"'
            raise RecordingError(f"{where}: {_COMMAS}")
        if delimiter == "," and len(cells) == 2 * width and all(is_number(cell) for cell in cells):
            raise RecordingError(
                f'"{path}": row {number} has {len(cells)} cells under {width} column names: decimal commas? '
                "Write decimal points, or part the columns by semicolons"
            )


class _Parse:
    """One pass over the file, block by block, into one array a column."""

    def __init__(
        self, path: Path, headings: list[str], skip: int, delimiter: str, selection: Selection, encoding: str, decimal: str
    ) -> None:
        self.path, self.headings, self.skip, self.delimiter, self.selection = path, headings, skip, delimiter, selection
        self.encoding, self.decimal = encoding, decimal
        self.torn: list[tuple[int, str]] = []
        self.words: dict[str, tuple[int, int, str]] = {}  # column: how many, first row, first word

    def table(self) -> RawTable:
        import pyarrow as pa

        sources = [column.source for column in self.selection.columns]
        try:
            parts = self._blocks(sources, pa.float64())
        except pa.ArrowInvalid:
            self.torn.clear()
            parts = self._blocks(sources, pa.string())  # words among the numbers: slower, and it says which
        rows = sum(len(part) for part in parts[sources[0]])
        if not rows:
            raise RecordingError(f'"{self.path}": there is a heading and no whole row below it')
        findings = list(self.selection.findings) + self._torn(rows) + self._words(rows)
        values: dict[str, NDArray[np.float64]] = {}
        for column in self.selection.columns:
            values[column.key] = column.to_si(np.concatenate(parts.pop(column.source)))
        units = {column.key: column.unit for column in self.selection.columns}
        time = values.pop(self.selection.columns[0].key)
        return RawTable(time, values, units, findings)

    def _blocks(self, sources: list[str], type_: pa.DataType) -> dict[str, list[NDArray[np.float64]]]:
        parts: dict[str, list[NDArray[np.float64]]] = {source: [] for source in sources}
        done = 0
        for batch in self._batches(sources, type_):
            for source in sources:
                parts[source].append(self._numbers(batch.column(source), source, done))
            done += batch.num_rows
        return parts

    def _batches(self, sources: list[str], type_: pa.DataType) -> Iterator[Any]:
        import pyarrow as pa
        from pyarrow import csv as arrow

        try:
            with self.path.open("rb") as file:  # opened here: a name may be none that Arrow can take
                yield from arrow.open_csv(
                    file,
                    read_options=arrow.ReadOptions(
                        use_threads=False, column_names=self.headings, skip_rows=self.skip, block_size=1 << 22,
                        encoding=self.encoding,
                    ),
                    parse_options=arrow.ParseOptions(delimiter=self.delimiter, invalid_row_handler=self._on_torn),
                    convert_options=arrow.ConvertOptions(
                        column_types=dict.fromkeys(sources, type_), include_columns=sources, null_values=_MISSING,
                        decimal_point=self.decimal,
                    ),
                )  # fmt: skip
        except pa.ArrowInvalid as error:
            if "Empty CSV" in str(error):
                raise RecordingError(f'"{self.path}": there is a heading and no row below it') from None
            raise

    def _on_torn(self, row: Any) -> str:
        if not row.text.lstrip().startswith("#"):
            self.torn.append((row.number or 0, row.text[:40]))
        return "skip"

    def _numbers(self, cells: pa.Array, source: str, done: int) -> NDArray[np.float64]:
        import pyarrow as pa
        from pyarrow import compute

        if cells.type == pa.float64():
            return cells.to_numpy(zero_copy_only=False)
        numbers = np.full(len(cells), np.nan)
        for row, cell in enumerate(compute.utf8_trim_whitespace(cells).to_pylist()):
            if cell is None or cell in _MISSING:
                continue
            try:
                numbers[row] = float(cell.replace(",", ".", 1) if self.decimal == "," else cell)
            except ValueError:
                if is_number(cell.replace(",", ".", 1)):
                    where = f'"{self.path}": row {done + row + 1} of "{source}" holds "{cell}"'
                    raise RecordingError(f"{where}: {_COMMAS}") from None
                count, first, word = self.words.get(source, (0, done + row + 1, cell))
                self.words[source] = (count + 1, first, word)
        return numbers

    def _torn(self, rows: int) -> list[Finding]:
        if not self.torn:
            return []
        number, text = self.torn[0]
        where = f'row {number} (it begins "{text}")' if number else f'the one that begins "{text}"'
        if len(self.torn) > 1 + _MOST_TORN * rows:
            raise RecordingError(
                f'"{self.path}": {len(self.torn)} rows have more or fewer cells than there are columns '
                f"({len(self.headings)}), first {where}; write one cell a column, with decimal points"
            )
        many = "1 row has" if len(self.torn) == 1 else f"{len(self.torn)} rows have"
        says = f"{many} more or fewer cells than there are columns, first {where}: cut off while writing? Dropped"
        return [Finding(self.path.name, "torn row", says, severity="warning", use="repaired")]

    def _words(self, rows: int) -> list[Finding]:
        findings = []
        by_source = {column.source: column for column in self.selection.columns}
        for source, (count, first, word) in self.words.items():
            if count == rows and _CLOCK_TEXT.match(word):
                raise RecordingError(
                    f'"{self.path}": column "{source}" holds times of day, first "{word[:30]}"; write it in seconds from the first row on, '
                    "in pandas: (times - times.iloc[0]).dt.total_seconds() of times = pd.to_datetime(...)"
                )
            if count == rows:
                raise RecordingError(
                    f'"{self.path}": column "{source}" holds words, first "{word[:20]}"; it must hold numbers'
                )
            where = f'first "{word[:20]}" in row {first}'
            says = f'"{source}" holds words in {count} of {rows} rows, {where}; taken as missing'
            findings.append(Finding(by_source[source].key, "words", says, severity="warning", use="repaired"))
        return findings
