"""CSV: any of the usual delimiters, a byte-order mark, comments, blank and torn lines, words among the numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError
from exo_sim.inputs import is_number
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, Selection
from exo_sim.recording.csv_beginning import COMMAS, UTF8, begin, encoding_of, refuse_decimal_comma, sample_of
from exo_sim.recording.data_quality_finding import Finding

if TYPE_CHECKING:
    import pyarrow as pa

_MISSING = ["", "nan", "NaN", "NAN", "-nan", "NA", "N/A", "null", "NULL", "None", "#N/A"]
#: Lines with another number of cells are dropped and said, up to this share of the rows; beyond it the file is refused.
_MOST_TORN = 0.01
#: Time of day as logs write it.
_CLOCK_TEXT = re.compile(r"(?:\d{4}-\d\d-\d\d[T ])?\d{1,2}:\d\d(?::\d\d(?:[.,]\d+)?)?$")


def read_csv(path: Path, column_map: ColumnMap | None = None) -> RawTable:
    """Read a CSV file.

    Raises:
        RecordingError: not text, no heading, no rows, decimal commas, too many torn lines, or what `select` refuses.
    """
    raw = sample_of(path)
    encoding = encoding_of([raw], whole=False)
    begun = begin(path, raw, encoding, column_map)
    with path.open("rb") as file:  # only now: what is too long is not read to its end
        whole = encoding_of(iter(lambda: file.read(1 << 24), b""))
    if whole != encoding:
        encoding, begun = whole, begin(path, raw, whole, column_map)
    decimal = column_map.decimal if column_map else "."
    if decimal == ".":
        refuse_decimal_comma(path, begun.body, begun.delimiter, len(begun.headings))
    if encoding != UTF8:
        says = f'"{path.name}" is not UTF-8 text; it was read as {encoding}, in which every byte is a character'
        begun.selection.findings.append(Finding(path.name, "encoding", says, severity="info", use="repaired"))
    return _Parse(path, begun.headings, begun.skip, begun.delimiter, begun.selection, encoding, decimal).table()


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
                    raise RecordingError(f"{where}: {COMMAS}") from None
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
