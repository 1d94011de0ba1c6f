"""Which columns of a file to load: headings to signals, with what cannot be used said once and left in the file."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from exo_sim import units
from exo_sim.errors import RecordingError, UnitError, near
from exo_sim.recording import columns
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.columns import Column
from exo_sim.recording.data_quality_finding import Finding

#: Signals, in bytes of memory, beyond which a file is refused. One hour at 1 kHz is 29 MB a column.
MOST_BYTES = 2_000_000_000
#: What a clock is called in other people's files.
_CLOCK = re.compile(r"\W*(?:.*[./])?(?:t|time|times|timestamp|stamp|clock|zeit)(?:\W.*)?$", re.IGNORECASE)


@dataclass(frozen=True)
class Selection:
    """The columns of a file that will be read; the first is the time."""

    columns: tuple[Column, ...]
    findings: list[Finding] = field(default_factory=list)

    def refuse_if_too_long(self, name: str, rows: float) -> None:
        """Raise RecordingError where `rows` rows would not fit into `MOST_BYTES`."""
        need = 8.0 * rows * len(self.columns)
        if need > MOST_BYTES:
            most = int(MOST_BYTES / 8 / len(self.columns))
            raise RecordingError(
                f'"{name}": about {rows:.3g} rows of {len(self.columns)} columns would take {need / 1e9:.3g} GB; '
                f"cut it into pieces of at most {most:.2g} rows, or thin it out"
            )


def select(name: str, headings: Sequence[str], column_map: ColumnMap | None = None) -> Selection:
    """Find the time and every signal among the headings of a file.

    A heading that a column map names is what the map says; every other must be of the contract. A heading with an
    unknown name or unit becomes a finding and is left out.

    Raises:
        RecordingError: no time, no signal, one signal or heading twice, a gauge unit, or a map that names columns that
            are not there.
    """
    name_of_file = f'"{name}"'
    counts = Counter(heading for heading in headings if heading.strip())
    if doubled := sorted(heading for heading, count in counts.items() if count > 1):
        raise RecordingError(f'{name_of_file}: column "{doubled[0]}" is there {counts[doubled[0]]} times; rename or remove one')
    mapped = dict(column_map.columns) if column_map else {}
    absent = [source for source in mapped if source not in counts]
    if absent and column_map:
        there = ", ".join(f'"{heading}"' for heading in list(headings)[:8])
        asked = f'column "{absent[0]}" of column map "{column_map.path}"'
        raise RecordingError(f"{name_of_file}: {asked} is not in it; there is: {there}")
    chosen: list[Column] = []
    findings: list[Finding] = []
    for at, heading in enumerate(headings, 1):
        if not heading.strip() and heading not in mapped:
            says = f"column {at} has no name; it was left out"
            findings.append(Finding(heading, "unknown column", says, severity="info", use="set aside"))
            continue
        try:
            chosen.append(mapped[heading] if heading in mapped else columns.resolve(heading))
        except UnitError as error:
            unit = columns.split(heading)[1] or ""
            if units.is_gauge(unit) or columns.split(heading)[0] == columns.TIME:
                raise RecordingError(f"{name_of_file}: {error}") from None
            says = _set_aside(error)
            findings.append(Finding(heading, "unit", says, severity="fault", use="set aside"))
        except RecordingError as error:
            if not mapped:
                says = _set_aside(error)
                findings.append(Finding(heading, "unknown column", says, severity="warning", use="set aside"))
    return Selection(_time_first(name_of_file, chosen, findings, headings), findings)


def _is_clock(heading: str) -> bool:
    return bool(_CLOCK.match(heading) or near(heading.partition("[")[0].strip().lower(), ("time", "timestamp")))


def _set_aside(error: Exception) -> str:
    return f"{error} The column was set aside" if str(error).endswith("?") else f"{error}; the column was set aside"


def _time_first(name: str, chosen: list[Column], findings: list[Finding], headings: Sequence[str]) -> tuple[Column, ...]:
    times = [column for column in chosen if column.key == columns.TIME]
    there = ", ".join(f'"{heading[:60]}"' for heading in list(headings)[:8]) + (", ..." if len(headings) > 8 else "")
    if not times:
        clock = next((heading for heading in headings if _is_clock(heading)), "")
        line = f' with the line "{clock[:60]}" = "time [s]"' if clock else ""
        raise RecordingError(f'{name}: there is no column "time [s]"; name the clock so, or hand in a column map{line}; there is: {there}')
    by_key: dict[str, Column] = {}
    for column in chosen:
        if column.key in by_key:
            twin = by_key[column.key].source
            raise RecordingError(f'{name}: columns "{twin}" and "{column.source}" are both {column.key}; keep one')
        by_key[column.key] = column
    if len(chosen) == 1:
        telling = [finding.says for finding in findings if finding.kind != "unknown column" or "did you mean" in finding.says]
        why = f" ({telling[0]})" if telling else ""
        says = f'{name}: there is no signal beside the time{why}; name columns like "piston.pressure_1 [Pa]", or hand in a column map'
        says += f"; there is: {there}"
        raise RecordingError(says)
    if chosen[0].key != columns.TIME:
        says = f'"time" is not the first column of the file; "{times[0].source}" was taken'
        findings.append(Finding(columns.TIME, "order", says, severity="info", use="used"))
    return (times[0], *(column for column in chosen if column.key != columns.TIME))


@dataclass
class RawTable:
    """What stands in a file, in SI, the clock not yet in order.

    Attributes:
        time: Seconds, shape (n,).
        values: Key to values, shape (n,).
        units: Key to SI unit.
        findings: What was odd about the file.
        metadata: Text that travels with it.
    """

    time: NDArray[np.float64]
    values: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    findings: list[Finding]
    metadata: dict[str, str] = field(default_factory=dict)
