"""OpenSim's storage files (`.mot`, `.sto`): read as they are, read as a recording, and written.

The format is the one of OpenSim 3 and 4 (OpenSim documentation, "Storage (.sto) Files" and "Motion (.mot) Files"): header lines are
`key=value` or, in files of SIMM, `key value`, up to the word `endheader`; then one line of labels and rows of numbers. `inDegrees=yes` says
that rotations are in degrees, translations are in metres all the same. As a recording its columns are the contract's, or OpenSim's
coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exo_sim.errors import RecordingError, nearest
from exo_sim.inputs import check_regular, is_number, refusing
from exo_sim.recording import columns
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, select
from exo_sim.recording.table import Recording

#: Lines within which a header must end, and bytes beyond which a file is refused.
_MOST_HEADER, _MOST_BYTES = 500, 500_000_000
#: How labels of coordinates end that are lengths and no angles.
TRANSLATIONS = ("_tx", "_ty", "_tz")
#: How the labels of other quantities than coordinates end, in files of inverse dynamics, force plates and markers.
_NO_COORDINATE = ("_moment", "_force", "_activation", "_vx", "_vy", "_vz", "_px", "_py", "_pz", "_mx", "_my", "_mz")


@dataclass(frozen=True)
class OpenSimTable:
    """What a `.mot` or `.sto` file holds, numbers as they are written.

    Attributes:
        path: The file.
        name: First line of the header: what the file calls itself.
        time: Seconds, shape (n,).
        columns: Label to numbers, shape (n,), in the order of the file; the time is not among them.
        in_degrees: Whether rotations are in degrees. The header says so; a file that does not say is in radian, as OpenSim takes it.
        header: Keys of the header in lower case, to their text.
    """

    path: Path
    name: str
    time: NDArray[np.float64]
    columns: Mapping[str, NDArray[np.float64]]
    in_degrees: bool
    header: Mapping[str, str]

    def angle(self, label: str) -> NDArray[np.float64]:
        """Return a rotation, or its rate, in radian.

        Raises:
            RecordingError: there is no column of this label.
        """
        values = self._of(label)
        return np.deg2rad(values) if self.in_degrees else values

    def coordinate(self, label: str) -> NDArray[np.float64]:
        """Return a coordinate in SI: metres where the label ends in `_tx`, `_ty` or `_tz`, else radian.

        Raises:
            RecordingError: there is no column of this label.
        """
        return self._of(label) if is_translation(label) else self.angle(label)

    def _of(self, label: str) -> NDArray[np.float64]:
        if label not in self.columns:
            raise RecordingError(f'"{self.path}": there is no column "{label}"{nearest(label, self.columns)}')
        return self.columns[label]


def is_translation(label: str) -> bool:
    """Return True where the label of a coordinate says that it is a length: `pelvis_tx`, `/jointset/ground_pelvis/pelvis_ty/value`."""
    parts = label.strip("/").split("/")
    coordinate = parts[-2] if len(parts) > 1 and parts[-1] in ("value", "speed") else parts[-1]
    return coordinate.endswith(TRANSLATIONS)


def read_storage(path: str | Path) -> OpenSimTable:
    """Read a `.mot` or `.sto` file whole.

    Raises:
        RecordingError: the file is missing, not text, has no header, no time, no rows, labels twice, or rows that do not fit; the message
            names file, line and what to do.
    """
    path = Path(path)
    lines = _lines(path)
    end = next((i for i, line in enumerate(lines[:_MOST_HEADER]) if line.strip().lower() == "endheader"), None)
    if end is None:
        raise RecordingError(f'"{path}": no line "endheader" in the first {_MOST_HEADER}; is it a .mot or .sto file of OpenSim?')
    header = _header(lines[:end])
    kind = header.get("datatype", "double")
    if kind.lower() != "double":
        raise RecordingError(f'"{path}": its cells are {kind}; write one number a cell (DataType=double)')
    at = next((i for i in range(end + 1, len(lines)) if lines[i].strip()), None)
    if at is None:
        raise RecordingError(f'"{path}": no line of labels below "endheader": cut off while copying?')
    labels = _labels(path, lines[at], at + 1)
    time, *values = _rows(path, lines, at + 1, labels).T.copy()
    degrees = header.get("indegrees", "no").lower()
    if degrees not in ("yes", "no"):
        raise RecordingError(f'"{path}": inDegrees={degrees}; write inDegrees=yes or inDegrees=no')
    name = lines[0].strip() if end and "=" not in lines[0] else path.stem
    return OpenSimTable(path, name, time, dict(zip(labels[1:], values)), degrees == "yes", header)


def _lines(path: Path) -> list[str]:
    with refusing(lambda says: RecordingError(f'"{path}": {says}')):
        check_regular(path)
        if path.stat().st_size > _MOST_BYTES:
            raise RecordingError(f'"{path}": more than {_MOST_BYTES / 1e6:.0f} MB; cut it into pieces')
        raw = path.read_bytes()
    if b"\0" in raw:
        raise RecordingError(f'"{path}": it is not text; is it a .mot or .sto file of OpenSim?')
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _header(lines: list[str]) -> dict[str, str]:
    header = {}
    for line in lines[1:] if lines and "=" not in lines[0] else lines:
        key, equals, value = line.strip().partition("=")
        if not equals:
            key, _, value = line.strip().partition(" ")
        if key:
            header[key.strip().lower()] = value.strip()
    return header


def _labels(path: Path, line: str, number: int) -> list[str]:
    labels = [cell.strip() for cell in line.rstrip("\t").split("\t")] if "\t" in line else line.split()
    if labels[0].lower() != "time":
        raise RecordingError(f'"{path}": line {number} begins "{labels[0][:40]}"; the first column must be "time"')
    seen: set[str] = set()
    for label in labels:
        if not label or label in seen:
            what = f'the label "{label[:40]}" stands there twice' if label else "a column has no label"
            raise RecordingError(f'"{path}": line {number}: {what}; give each column a name of its own')
        seen.add(label)
    if len(labels) < 2:
        raise RecordingError(f'"{path}": line {number}: there is no column beside the time')
    return labels


def _rows(path: Path, lines: list[str], first: int, labels: list[str]) -> NDArray[np.float64]:
    """Return the numbers below the labels, shape (n, columns)."""
    rows = []
    width = len(labels)
    last = max((i for i in range(first, len(lines)) if lines[i].strip()), default=first - 1)
    for i in range(first, last + 1):
        line = lines[i]
        cells = line.split()
        if not cells:
            continue
        if len(cells) != width and "\t" in line:  # an empty cell between two tabulators is a missing sample
            cells = [cell.strip() or "nan" for cell in line.rstrip("\n").split("\t")][:width]
        if len(cells) != width:
            raise RecordingError(f'"{path}": line {i + 1} has {len(cells)} numbers under {width} labels: cut off while copying?')
        try:
            rows.append([float(cell) for cell in cells])
        except ValueError:
            word = next(cell for cell in cells if not is_number(cell))
            raise RecordingError(f'"{path}": line {i + 1} holds "{word[:40]}" where a number must stand') from None
    if not rows:
        raise RecordingError(f'"{path}": there are labels and no row below them')
    return np.array(rows)


def read_sto(path: Path, column_map: ColumnMap | None = None) -> RawTable:
    """Read a `.mot` or `.sto` file.

    A label of the contract ("piston.pressure_1 [Pa]") is what it says. A coordinate of OpenSim ("knee_angle_r",
    "/jointset/knee_r/knee_angle_r/value") becomes the position of a joint of that name, ".../speed" its velocity. A column map names the
    rest.

    Raises:
        RecordingError: the file is none of OpenSim's, or what `select` refuses.
    """
    storage = read_storage(path)
    mapped = column_map.columns if column_map else {}
    named = [("time" if "time" in mapped else "time [s]", "time")]
    named += [(label if label in mapped else _heading(label, storage.in_degrees), label) for label in storage.columns]
    headings = dict(named)
    selection = select(str(path), [heading for heading, _ in named], column_map)
    numbers = {"time": storage.time, **storage.columns}
    values = {column.key: column.to_si(np.array(numbers[headings[column.source]])) for column in selection.columns}
    units = {column.key: column.unit for column in selection.columns}
    return RawTable(values.pop(columns.TIME), values, units, selection.findings, {"opensim name": storage.name})


def _heading(label: str, in_degrees: bool) -> str:
    if "[" in label or label.endswith(_NO_COORDINATE):
        return label
    parts = label.strip("/").split("/")
    coordinate = parts[-2] if len(parts) > 1 and parts[-1] in ("value", "speed") else parts[-1]
    if "." in coordinate:
        return label
    unit = "m" if is_translation(label) else "deg" if in_degrees else "rad"
    return f"{coordinate}.velocity [{unit}/s]" if parts[-1] == "speed" else f"{coordinate}.position [{unit}]"


def write_sto(path: Path, recording: Recording) -> None:
    """Write a recording as an OpenSim storage file: one label a column, named as the contract has them, SI and radian.

    Raises:
        OSError: it cannot be written.
    """
    labels = [columns.heading(key, recording.units[key]).replace("\t", " ") for key in recording.columns]
    table = np.column_stack([recording.time, *recording.columns.values()])
    with path.open("w", encoding="utf-8", newline="\n") as file:
        name = recording.name.replace("\n", " ").replace("=", " ")
        file.write(f"{name}\nversion=1\nnRows={len(table)}\nnColumns={table.shape[1]}\ninDegrees=no\nendheader\n")
        file.write("\t".join(["time", *labels]) + "\n")
        for row in table:
            file.write("\t".join(map(repr, row.tolist())) + "\n")
