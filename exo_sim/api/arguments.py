"""What functions of the API take: quantities as numbers or text, rigs, recordings and column maps as paths or objects."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from exo_sim import units
from exo_sim.api.recording import Recording
from exo_sim.api.rig import Rig
from exo_sim.errors import OutputError, RecordingError, RigError, ScenarioError, UnitError
from exo_sim.recording import table
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.reader import Reading, read
from exo_sim.rig import schema
from exo_sim.rig.included_machines import rig_file

#: A path, or what stands in such a file.
RigLike = str | os.PathLike[str] | schema.Rig
RecordingLike = str | os.PathLike[str] | table.Recording
Columns = str | os.PathLike[str] | Mapping[str, Any] | ColumnMap | None
#: An SI number, or text with a unit.
Quantity = float | str

#: On the back where nobody says anything [kg].
USUAL_PAYLOAD = 34.0


def quantity(value: Quantity, unit: str, name: str, low: float = -math.inf, high: float = math.inf) -> float:
    """Return a quantity in SI.

    Args:
        value: A number, which counts as SI, or text like "34 kg".
        unit: The SI unit.
        name: What it is, for errors.
        low, high: Bounds in SI.

    Raises:
        UnitError: it is no quantity of that unit.
        ScenarioError: it is out of bounds.
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        si = float(value)
        if not math.isfinite(si):
            raise UnitError(f'{name} = {value}: not a finite number; give it in {unit} or as text like "1 {unit}"')
    else:
        try:
            si = units.parse(value, unit)
        except UnitError as error:
            raise UnitError(f"{name}: {error}") from None
    if not low <= si <= high:
        raise ScenarioError(f"{name} = {value}: must be within {low:g} to {high:g} {unit}")
    return si


def rig_of(rig: RigLike | None) -> Rig:
    """Return a rig; a path may be the name of an included machine, None is the worn machine that comes with the package.

    Raises:
        RigError: it cannot be read, or is no rig.
    """
    if rig is None:
        return Rig.included()
    if isinstance(rig, schema.Rig):
        return Rig.of(rig)
    if not isinstance(rig, str | os.PathLike):
        raise RigError(f"a rig is a path or exo.Rig, not a {type(rig).__name__}")
    return Rig.load(rig_file(rig))


def payload_of(machine: Rig, payload: Quantity | None) -> float:
    """Return the mass on the back [kg]: what is asked for, else what the rig's `[bodies.payload]` says, else `USUAL_PAYLOAD`.

    Raises:
        UnitError, ScenarioError: as `quantity`.
    """
    if payload is None:
        return machine.body_masses.get("payload", USUAL_PAYLOAD)
    return quantity(payload, "kg", "payload", low=0.0)


def reading_of(recording: RecordingLike, columns: Columns = None) -> Reading:
    """Return a recording with what was odd about its file.

    Raises:
        RecordingError: it cannot be read, or is no recording.
    """
    if isinstance(recording, Recording):
        return recording.as_read()
    if isinstance(recording, table.Recording):
        return Reading(recording, ())
    if not isinstance(recording, str | os.PathLike):
        raise RecordingError(f"a recording is a path or exo.Recording, not a {type(recording).__name__}; see exo.Recording.from_pandas")
    return read(Path(recording), columns_of(columns))


def columns_of(columns: Columns) -> Path | ColumnMap | None:
    """Return a column map from a path, an object, or a dictionary of foreign names."""
    from exo_sim.api.recording import map_of

    return map_of(columns)


def check_target(path: str | os.PathLike[str]) -> Path:
    """Return where a recording for the viewer goes.

    Raises:
        OutputError: it ends in something else than `.rrd`.
    """
    target = Path(path)
    if target.suffix.lower() != ".rrd":
        raise OutputError(f'cannot write "{target}": a recording for the viewer ends in .rrd')
    return target
