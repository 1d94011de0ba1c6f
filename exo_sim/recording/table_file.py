"""Writing the table of a recording: Parquet, the archive, and CSV. The same recording gives the same bytes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from exo_sim.errors import OutputError
from exo_sim.outputs import replacing
from exo_sim.recording import columns
from exo_sim.recording.table import Recording

if TYPE_CHECKING:
    import pyarrow as pa

_ROW_GROUP = 1 << 18


def write_table(path: str | Path, recording: Recording) -> None:
    """Write a recording as `.parquet` or `.csv`, columns named as the contract has them, values in SI.

    Parquet keeps every bit and the metadata (in the schema); CSV keeps every bit of the values.

    Raises:
        OutputError: the ending is another, or the file cannot be written.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".parquet", ".csv"):
        raise OutputError(f'cannot write "{path}": a table ends in .parquet or .csv')
    with replacing(path) as beside:
        if ending == ".parquet":
            from pyarrow import parquet

            parquet.write_table(
                _table(recording), beside, compression="lz4", use_dictionary=False, use_byte_stream_split=True, row_group_size=_ROW_GROUP
            )
        else:
            from pyarrow import csv

            csv.write_csv(_table(recording), beside)


def _table(recording: Recording) -> pa.Table:
    import pyarrow as pa

    names = [columns.heading(columns.TIME, "s")]
    names += [columns.heading(key, recording.units[key]) for key in recording.columns]
    table = pa.table([pa.array(recording.time), *(pa.array(values) for values in recording.columns.values())], names)
    return table.replace_schema_metadata({key: recording.metadata[key] for key in sorted(recording.metadata)})
