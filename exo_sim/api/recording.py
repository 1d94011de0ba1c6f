"""`exo.Recording`: signals on one clock, from a file, a table in memory, or a simulation."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from exo_sim.api.notebook import html_table
from exo_sim.errors import RecordingError, UnitError
from exo_sim.plain_text import table as text_table
from exo_sim.recording import columns as headings
from exo_sim.recording import reader, table
from exo_sim.recording.column_map import ColumnMap, column_map_of
from exo_sim.recording.column_selection import RawTable, select
from exo_sim.recording.data_quality_finding import Finding

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from exo_sim.api.figure import Picture


@dataclass(frozen=True, repr=False, eq=False)
class Recording(table.Recording):
    """Signals on one clock, in SI and radian: `recording["piston.pressure_1"]`, `recording.time`.

    Attributes:
        name: What to call it in reports.
        time: Seconds, strictly increasing, shape (n,). Need not be uniform.
        columns: `"<part>.<signal>"` to values, shape (n,); NaN where a sample is missing.
        units: `"<part>.<signal>"` to the SI unit of its values.
        metadata: Text that travels with it.
        breaks: Seconds at which the clock was mended; no prediction runs across.
        findings: What was odd about the file and what was done about it.

    Raises:
        RecordingError: columns of unequal length, or with a name that is no signal.
    """

    findings: tuple[Finding, ...] = ()

    def __post_init__(self) -> None:
        time = np.asarray(self.time, dtype=float)
        values = {key: np.asarray(column, dtype=float) for key, column in self.columns.items()}
        for key, column in values.items():
            headings.signal_of(key)
            if column.shape != time.shape or time.ndim != 1:
                raise RecordingError(f'column "{key}" has shape {column.shape}, the time {time.shape}; give one value a sample')
            if key not in self.units:
                raise RecordingError(f'column "{key}" has no unit; give it in units, or name columns with units in Recording.from_columns')
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "columns", values)

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], columns: str | os.PathLike[str] | Mapping[str, Any] | None = None, overlay: str = ""
    ) -> Recording:
        """Read a recording from a file; the ending says of which kind (`docs/recordings.md` lists them).

        Args:
            path: The file.
            columns: Foreign names: a column map (TOML), or a dictionary like `{"P1": "piston.pressure_1 [bar]"}`.
            overlay: Of an `.rrd` that `compare` or `diagnose` wrote: "simulated" or "free_run", "before" or "after", instead of what
                was recorded.

        Raises:
            RecordingError: the file is missing or cannot be used; one line says why and what to do.
        """
        if overlay:
            return cls.of(reader.read_overlay(Path(path), overlay))
        return cls.of(reader.read(Path(path), map_of(columns)))

    @classmethod
    def of(cls, recording: table.Recording | reader.Reading) -> Recording:
        """Return a recording of the package's inside as this class."""
        if isinstance(recording, cls):
            return recording
        reading = recording if isinstance(recording, reader.Reading) else reader.Reading(recording, ())
        own = {each.name: getattr(reading.recording, each.name) for each in fields(table.Recording)}
        return cls(**own, findings=reading.findings)

    @classmethod
    def from_columns(cls, values: Mapping[str, Any], name: str = "recording", columns: Mapping[str, Any] | None = None) -> Recording:
        """Make a recording of arrays in memory; it is checked and mended as a file would be.

        Args:
            values: Headings with units, as in a file, to values: `{"time [s]": t, "piston.pressure_1 [bar]": p}`.
            name: What to call it.
            columns: Foreign names, as in `load`.

        Raises:
            RecordingError: no time, no signal, an unknown name or unit, or columns of unequal length.
        """
        arrays: dict[str, np.ndarray] = {}
        for heading, column in values.items():
            try:
                arrays[str(heading)] = np.array(column, dtype=float)
            except (TypeError, ValueError):
                raise RecordingError(f'"{name}": column "{heading}" holds something that is no number') from None
        found = map_of(columns)
        selection = select(name, list(arrays), found if isinstance(found, ColumnMap) else None)
        shapes = {column.source: arrays[column.source].shape for column in selection.columns}
        time_shape = shapes[selection.columns[0].source]
        for source, shape in shapes.items():
            if shape != time_shape or len(shape) != 1:
                raise RecordingError(f'"{name}": column "{source}" has shape {shape}, the time {time_shape}; give one value a sample')
        signals = {column.key: column.to_si(arrays[column.source]) for column in selection.columns}
        units = {column.key: column.unit for column in selection.columns}
        raw = RawTable(signals.pop(headings.TIME), signals, units, list(selection.findings))
        return cls.of(reader.tidy(Path(name), raw))

    @classmethod
    def from_pandas(cls, frame: pd.DataFrame, name: str = "recording", columns: Mapping[str, Any] | None = None) -> Recording:
        """Make a recording of a data frame: columns with units, the time as a column or as the index.

        Raises:
            RecordingError: as `from_columns`.
        """
        values = {str(heading): frame[heading].to_numpy() for heading in frame.columns}
        mapped = {source for source, to in (columns or {}).items() if str(to).startswith(headings.TIME)}
        if not any(_is_time(heading) or heading in mapped for heading in values):
            index = frame.index.name or ""
            values = {str(index) if _is_time(str(index)) or index in mapped else "time [s]": frame.index.to_numpy(), **values}
        return cls.from_columns(values, name, columns)

    def to_pandas(self) -> pd.DataFrame:
        """Return a data frame: one column a signal, headings with units, indexed by "time [s]"."""
        pandas = _needs("pandas", "to_pandas")
        index = pandas.Index(self.time, name=headings.heading(headings.TIME, "s"))
        return pandas.DataFrame({headings.heading(key, self.units[key]): column for key, column in self.columns.items()}, index=index)

    def to_xarray(self) -> xr.Dataset:
        """Return a data set: one variable a signal over "time", with `units` and `long_name` for plots, metadata as attributes."""
        xarray = _needs("xarray", "to_xarray")
        variables = {
            key: ("time", column, {"units": self.units[key], "long_name": f"{key.rsplit('.', 1)[0]}: {headings.signal_of(key).label}"})
            for key, column in self.columns.items()
        }
        time = ("time", self.time, {"units": "s", "long_name": "time"})
        return xarray.Dataset(variables, coords={"time": time}, attrs={"name": self.name, **self.metadata})

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the recording: `.parquet`, `.csv` or `.sto` as a table, `.rrd` for the rerun viewer.

        Returns:
            The path.

        Raises:
            OutputError: the ending is another, or the file cannot be written.
        """
        target = Path(path)
        if target.suffix.lower() == ".rrd":
            from exo_sim.recording.rrd_file import write_rrd

            write_rrd(target, self)
        else:
            from exo_sim.recording.table_file import write_table

            write_table(target, self)
        return target

    def plot(self, signals: Sequence[str] | None = None) -> Picture:
        """Draw signals over time, one panel for each kind, each part a line.

        Args:
            signals: Keys ("piston.pressure_1") or kinds ("pressure_1"); everything measured when None.

        Raises:
            RecordingError: a signal is not there.
        """
        from exo_sim.api.plots import panels

        return panels([("", self)], signals)

    def as_read(self) -> reader.Reading:
        """Return the recording as a reader of files gives it, with what was odd about the file."""
        return reader.Reading(self, self.findings)

    def _rows(self) -> list[list[str]]:
        rows = []
        for key, column in self.columns.items():
            known = column[np.isfinite(column)]
            span = [f"{known.min():.6g}", f"{known.max():.6g}"] if len(known) else ["", ""]
            rows.append([key, self.units[key], *span, str(int((~np.isfinite(column)).sum()))])
        return rows

    def _title(self) -> str:
        return f"recording {self.name}: {len(self.time)} samples over {self.duration:.4g} s"

    def __len__(self) -> int:
        return len(self.time)

    def __str__(self) -> str:
        lines = [self._title(), text_table(self._rows(), _HEADER), *(each.says for each in self.findings if each.severity != "info")]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<exo.Recording {self.name}: {len(self.columns)} signals, {len(self.time)} samples over {self.duration:.4g} s>"

    def _repr_html_(self) -> str:
        return html_table(self._rows(), _HEADER, self._title())


_HEADER = ("signal", "unit", "least", "greatest", "missing")


def map_of(columns: str | os.PathLike[str] | Mapping[str, Any] | ColumnMap | None) -> Path | ColumnMap | None:
    """Return a column map from a path, an object, or a dictionary: foreign name to heading, or with tables as in the TOML file.

    Raises:
        RecordingError: it is no column map.
    """
    if columns is None or isinstance(columns, ColumnMap):
        return columns
    if isinstance(columns, str | os.PathLike):
        return Path(columns)
    tables = columns if isinstance(columns.get("columns"), Mapping) else {"columns": dict(columns)}
    return column_map_of(tables, Path("columns"))


def _is_time(heading: str) -> bool:
    try:
        return headings.resolve(heading).key == headings.TIME
    except (RecordingError, UnitError):
        return False


def _needs(module: str, what: str) -> Any:
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise RecordingError(f"{what} needs {module}: pip install 'exo-sim-pneumatic[notebook]'") from None
