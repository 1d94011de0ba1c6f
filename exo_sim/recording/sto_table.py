"""OpenSim's `.sto` and `.mot` as recordings: read with the names of the contract or of OpenSim's coordinates, and written."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from exo_sim.recording import columns
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, select
from exo_sim.recording.foreign.opensim_storage import is_translation, read_storage
from exo_sim.recording.table import Recording

#: How the labels of other quantities than coordinates end, in files of inverse dynamics, force plates and markers.
_NO_COORDINATE = ("_moment", "_force", "_activation", "_vx", "_vy", "_vz", "_px", "_py", "_pz", "_mx", "_my", "_mz")


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
