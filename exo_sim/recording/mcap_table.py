"""MCAP files, such as bags of ROS 2: numbers in the messages of each topic, brought onto one clock."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from exo_sim.errors import RecordingError
from exo_sim.inputs import json_value
from exo_sim.recording import columns
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.column_selection import RawTable, Selection, select
from exo_sim.recording.data_quality_finding import Finding
from exo_sim.recording.one_clock import on_one_clock

#: Arrays with more entries than that are pictures or point clouds, no signals.
_MOST_ENTRIES = 64
#: Messages of one number, to the field that holds it and its unit; a topic `/piston/pressure_1` of one is the signal `piston.pressure_1`.
_PLAIN = {
    "sensor_msgs/msg/FluidPressure": ("fluid_pressure", "Pa"),
    "sensor_msgs/msg/Temperature": ("temperature", "degC"),
    "std_msgs/msg/Float64": ("data", None),
    "std_msgs/msg/Float32": ("data", None),
}
_JOINTS = "sensor_msgs/msg/JointState"


def read_mcap(path: Path, column_map: ColumnMap | None = None) -> RawTable:
    """Read an MCAP file whose messages are ROS 2's (CDR) or JSON.

    Signals are called `/topic.field`, entries of arrays `/topic.field[2]`, of a JointState `/topic.position[knee_r]`; a column map says
    which is which. Without a map, JointState gives the position and velocity of its joints in radian, and a topic that ends in a signal of
    the contract (`/piston/pressure_1`, a FluidPressure) that signal. Times are those of the message's header, else of its log, from the
    first on.

    Raises:
        RecordingError: not a whole MCAP file, an encoding that is not read, no numbers, or what `select` refuses.
    """
    series, kinds = _scan(path)
    if not series:
        raise RecordingError(f'"{path}": no message in it holds numbers')
    mapped = column_map.columns if column_map else {}
    named = [(name if name in mapped else _heading(name, kinds), name) for name in series]
    headings = dict(named)
    known = ColumnMap(column_map.path, {n: c for n, c in mapped.items() if c.key != columns.TIME}) if column_map else None
    selection = select(str(path), [f"{columns.TIME} [s]", *(heading for heading, _ in named)], known)
    findings = list(selection.findings)
    start = min(series[headings[column.source]][0][0] for column in selection.columns[1:])
    given = {}
    for column in selection.columns[1:]:
        times, numbers = (np.array(each, dtype=float) for each in series[headings[column.source]])
        given[column.key] = times - start, column.to_si(numbers)
        if column.source not in mapped and kinds.get(headings[column.source]) == _JOINTS and column.key.endswith(".position"):
            says = f'"{column.key}" comes from a JointState, which says no unit; radian was taken. A column map says otherwise'
            findings.append(Finding(column.key, "unit", says, severity="info", use="used"))
    time, values = on_one_clock(path, given, findings)
    return RawTable(time, values, {c.key: c.unit for c in selection.columns}, findings)


def _scan(path: Path) -> tuple[dict[str, tuple[list[float], list[float]]], dict[str, str]]:
    """Return times [s] and numbers by name, and the type of message that each name comes from."""
    try:
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory
    except ImportError:
        raise RecordingError(f"\"{path}\": MCAP needs mcap and mcap-ros2-support: pip install 'exo-sim-pneumatic[files]'") from None
    series: dict[str, tuple[list[float], list[float]]] = {}
    kinds: dict[str, str] = {}
    refused = ""
    factory, decoders, numbers_held = DecoderFactory(), {}, 0
    with path.open("rb") as file:
        try:
            for schema, channel, message in make_reader(file).iter_messages():
                if channel.id not in decoders:
                    decoders[channel.id] = (
                        json_value if channel.message_encoding == "json" else factory.decoder_for(channel.message_encoding, schema)
                    )
                decode = decoders[channel.id]
                if decode is None:
                    refused = refused or f'topic "{channel.topic}" is encoded as {channel.message_encoding or "nothing known"}'
                    continue
                content = decode(message.data)
                kind = schema.name if schema is not None else ""
                time = _stamp(content) or 1e-9 * message.log_time
                for field, number in _numbers(content, kind):
                    name = f"{channel.topic}.{field}"
                    kinds.setdefault(name, kind)
                    times, numbers = series.setdefault(name, ([], []))
                    times.append(time)
                    numbers.append(number)
                    numbers_held += 1
                if numbers_held % 4096 == 0:
                    Selection((columns.Column("", "", ""),)).refuse_if_too_long(str(path), 8.0 * numbers_held)
        except (RecordingError, MemoryError):
            raise
        except Exception as error:  # of many kinds, on broken files
            why = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
            raise RecordingError(f'"{path}": not a whole MCAP file ({why}): copied in part, or still being written?') from None
    if not series and refused:
        raise RecordingError(f'"{path}": {refused}; CDR of ROS 2 and JSON are read: convert it with "ros2 bag convert" or the mcap tool')
    return series, kinds


def _stamp(content: Any) -> float:
    header = content.get("header") if isinstance(content, dict) else getattr(content, "header", None)
    stamp = header.get("stamp") if isinstance(header, dict) else getattr(header, "stamp", None)
    if stamp is None:
        return 0.0
    parts: dict[str, Any] = stamp if isinstance(stamp, dict) else {name: getattr(stamp, name, 0) for name in ("sec", "nanosec")}
    return float(parts.get("sec", 0)) + 1e-9 * float(parts.get("nanosec", parts.get("nsec", 0)))


def _numbers(content: Any, kind: str) -> Iterator[tuple[str, float]]:
    """Yield field and number of everything in a message that is one; a JointState's arrays by the names of its joints."""
    if kind == _JOINTS:
        for field in ("position", "velocity", "effort"):
            for joint, number in zip(content.name, getattr(content, field)):
                yield f"{field}[{joint}]", float(number)
        return
    yield from _walked(content, "")


def _walked(content: Any, above: str) -> Iterator[tuple[str, float]]:
    if isinstance(content, bool | int | float):
        yield above or "value", float(content)
    elif isinstance(content, dict) or hasattr(content, "__slots__"):
        names = content if isinstance(content, dict) else content.__slots__
        for name in names:
            if name in ("header", "layout") or str(name).startswith("_"):
                continue
            inner = content[name] if isinstance(content, dict) else getattr(content, name)
            yield from _walked(inner, f"{above}.{name}" if above else str(name))
    elif isinstance(content, list | tuple | np.ndarray) and len(content) <= _MOST_ENTRIES:
        for i, inner in enumerate(content):
            yield from _walked(inner, f"{above}[{i}]")


def _heading(name: str, kinds: dict[str, str]) -> str:
    """Return the heading of the contract where the message says enough, else the name."""
    topic, _, field = name.partition(".")
    kind = kinds[name]
    if kind == _JOINTS:
        signal, _, joint = field.partition("[")
        units = {"position": "rad", "velocity": "rad/s"}
        return f"{joint.rstrip(']')}.{signal} [{units[signal]}]" if signal in units else name
    plain = _PLAIN.get(kind)
    parts = topic.strip("/").split("/")
    if plain is None or field != plain[0] or len(parts) < 2:
        return name
    key = f"{parts[-2]}.{parts[-1]}"
    try:
        signal_units = columns.signal_of(key).units
    except RecordingError:
        return name
    unit = plain[1] or (signal_units[0] if len(signal_units) == 1 else None)
    return name if unit is None else columns.heading(key, unit)
