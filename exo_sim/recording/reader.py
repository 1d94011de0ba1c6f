"""Reading a recording from a file, by its ending, to one table in SI and what was odd about it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from exo_sim.errors import RecordingError, misspelt, nearest, printable
from exo_sim.inputs import check_regular
from exo_sim.recording import clock_repair
from exo_sim.recording.clock_repair import in_rows
from exo_sim.recording.column_map import ColumnMap, read_column_map
from exo_sim.recording.column_selection import RawTable
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.table import Recording
from exo_sim.units import LARGEST, SMALLEST

#: Fewer samples than this say nothing.
FEWEST_SAMPLES = 10
#: Seconds from row to row between which a clock is one.
SHORTEST, LONGEST = 1e-8, 1e6


@dataclass(frozen=True)
class Reading:
    """A recording as it came out of its file.

    Attributes:
        recording: The signals.
        findings: What was odd about the file and what was done about it (`health.check` looks at the signals).
    """

    recording: Recording
    findings: tuple[Finding, ...]

    @property
    def breaks(self) -> tuple[float, ...]:
        """Seconds at which the clock was mended."""
        return self.recording.breaks


def read(path: str | Path, column_map: str | Path | ColumnMap | None = None) -> Reading:
    """Read a recording.

    Args:
        path: A `.csv` (also `.tsv`, `.txt`), `.parquet` (also of a LeRobot data set), `.rrd`, `.mat`, `.mcap`, `.mot` or `.sto` file.
        column_map: A TOML file that names foreign columns (`recording.column_map`), or what one holds.

    Raises:
        RecordingError: the file is missing, empty, cut off, too long for memory, has no time or no signals, or fewer
            than `FEWEST_SAMPLES` rows; one line says which, where and what to do.
    """
    path = Path(path)
    if not path.exists():
        raise RecordingError(f'"{path}": there is no such recording{misspelt(path)}')
    foreign = read_column_map(column_map) if isinstance(column_map, str | Path) else column_map
    try:
        check_regular(path)
    except ValueError as error:
        raise RecordingError(f'"{path}": {error}') from None
    try:
        if not path.stat().st_size:
            raise RecordingError(f'"{path}": the file is empty')
        return tidy(path, _reader(path)(path, foreign))
    except OSError as error:
        raise RecordingError(f'"{path}": {error.strerror or error}; it cannot be read') from None
    except MemoryError:
        raise RecordingError(f'"{path}": it does not fit into memory; cut it into pieces') from None


def read_overlay(path: Path, overlay: str) -> Reading:
    """Read what was simulated beside what was recorded, from an .rrd of `compare` or `diagnose`.

    Args:
        path: The file.
        overlay: "simulated", "free_run", "before" or "after".

    Raises:
        RecordingError: as `read`; a file of another kind, or without such signals.
    """
    from exo_sim.recording.rrd_table import OVERLAYS, read_rrd

    if path.suffix.lower() != ".rrd" or not path.exists():
        raise RecordingError(f'"{path}": overlays are in an .rrd that `exo-sim compare` or `exo-sim diagnose` wrote; there is none')
    if overlay not in OVERLAYS:
        raise RecordingError(f'overlay "{overlay}"{nearest(overlay, OVERLAYS)}')
    return tidy(path, read_rrd(path, overlay=overlay))


def _reader(path: Path) -> Callable[[Path, ColumnMap | None], RawTable]:
    # imported where used: pyarrow and rerun take their time
    ending = path.suffix.lower()
    if ending in (".csv", ".tsv", ".txt"):
        from exo_sim.recording.csv_table import read_csv

        return read_csv
    if ending in (".parquet", ".pq"):
        from exo_sim.recording.parquet_table import read_parquet

        return read_parquet
    if ending == ".rrd":
        from exo_sim.recording.rrd_table import read_rrd

        return read_rrd
    if ending in (".mot", ".sto"):
        from exo_sim.recording.opensim_table import read_sto

        return read_sto
    if ending == ".mat":
        from exo_sim.recording.mat_table import read_mat

        return read_mat
    if ending == ".mcap":
        from exo_sim.recording.mcap_table import read_mcap

        return read_mcap
    known = ".csv, .parquet, .rrd, .mat, .mcap, .mot or .sto"
    raise RecordingError(f'"{path}": a recording ends in {known}, not in "{ending}"')


def tidy(path: Path, raw: RawTable) -> Reading:
    """Put the clock in order and set empty columns aside.

    Raises:
        RecordingError: too few rows, or nothing but empty columns.
    """
    kept, clock_findings, breaks = clock_repair.in_order(str(path), raw.time)
    findings = [*raw.findings, *clock_findings]
    time = raw.time[kept]
    if len(time) < FEWEST_SAMPLES:
        of = f" of {len(raw.time)}" if len(raw.time) > len(time) else ""
        why = f" ({clock_findings[0].says})" if clock_findings else ""
        unsorted = "; sort the rows by time" if "steps back" in why and len(raw.time) >= FEWEST_SAMPLES else ""
        raise RecordingError(f'"{path}": {len(time)} usable rows{of}; at least {FEWEST_SAMPLES} are needed{why}{unsorted}')
    usual = float(np.median(np.diff(time)))
    if not SHORTEST < usual < LONGEST:
        raise RecordingError(f'"{path}": the clock steps by {usual:.3g} s from row to row; is the unit of "time" right?')
    columns = {}
    for key in list(raw.values):
        values = raw.values.pop(key)[kept]
        infinite = np.abs(values) > LARGEST
        if infinite.any():
            values = np.where(infinite, np.nan, values)
            count, first = int(infinite.sum()), int(np.argmax(infinite))
            says = f'"{key}" is infinite, or more than any sensor reads, in {in_rows(count)}, first row {first + 1}; taken as missing'
            findings.append(Finding(key, "infinite", says, severity="warning", use="repaired"))
        minute = (np.abs(values) < SMALLEST) & (values != 0.0)
        if minute.any():  # squares of such would be nothing, and their quotients no number
            values = np.where(minute, 0.0, values)
        if np.isnan(values).all():
            says = f'"{key}" holds no number in any of its {len(values)} rows; it was set aside'
            findings.append(Finding(key, "empty", says, severity="fault", use="set aside"))
            continue
        columns[key] = values
    if not columns:
        raise RecordingError(f'"{path}": no column beside the time holds a number; {len(time)} rows of nothing')
    units = {key: raw.units[key] for key in columns}
    return Reading(Recording(printable(path.stem), time, columns, units, raw.metadata, breaks), tuple(findings))
