"""Writing the table of a recording: Parquet, the archive, and CSV. The same recording gives the same bytes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from exo_sim.errors import OutputError
from exo_sim.outputs import replacing
from exo_sim.recording import arrow_without_pandas, columns
from exo_sim.recording.opensim_table import write_sto
from exo_sim.recording.table import Recording

if TYPE_CHECKING:
    import pyarrow as pa
    from pyarrow import parquet

_ROW_GROUP = 1 << 18


def write_table(path: str | Path, recording: Recording) -> None:
    """Write a recording as `.parquet`, `.csv` or OpenSim's `.sto`, columns named as the contract has them, values in SI.

    Parquet keeps every bit and the metadata (in the schema); the others keep every bit of the values.

    Raises:
        OutputError: the ending is another, or the file cannot be written.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".parquet", ".csv", ".sto"):
        raise OutputError(f'cannot write "{path}": a table ends in .parquet, .csv or .sto, a recording for the viewer in .rrd')
    with replacing(path) as beside:
        if ending == ".parquet":
            with writing_parquet(beside) as pieces:
                pieces.add(recording)
        elif ending == ".sto":
            write_sto(beside, recording)
        else:
            from pyarrow import csv

            csv.write_csv(_table(recording), beside)


@contextmanager
def writing_parquet(path: Path) -> Iterator[ParquetPieces]:
    """Give what writes a recording into `path` piece by piece, straight.

    Raises:
        OSError: the file cannot be written.
    """
    with ExitStack() as stack:
        yield ParquetPieces(path, stack)


class ParquetPieces:
    """Writes a recording into a Parquet file; `writing_parquet` gives one. What the first piece holds sets columns and metadata."""

    def __init__(self, path: Path, stack: ExitStack) -> None:
        self._path, self._stack = path, stack
        self._writer: parquet.ParquetWriter | None = None

    def add(self, recording: Recording) -> None:
        """Write the next piece: the columns of the first, at later times."""
        table = _table(recording)
        if self._writer is None:
            from pyarrow import parquet

            self._writer = self._stack.enter_context(
                parquet.ParquetWriter(
                    self._path, table.schema, compression="lz4", use_dictionary=False, use_byte_stream_split=True
                )
            )
        self._writer.write_table(table, row_group_size=_ROW_GROUP)


def _table(recording: Recording) -> pa.Table:
    import pyarrow as pa

    arrow_without_pandas.settle()
    names = [columns.heading(columns.TIME, "s")]
    names += [columns.heading(key, recording.units[key]) for key in recording.columns]
    table = pa.table([pa.array(recording.time), *(pa.array(values) for values in recording.columns.values())], names)
    return table.replace_schema_metadata({key: recording.metadata[key] for key in sorted(recording.metadata)})
