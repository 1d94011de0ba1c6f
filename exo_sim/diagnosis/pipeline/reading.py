"""Recordings and rig, read and put side by side; samples that a sensor cannot have seen are taken out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from exo_sim import conventions
from exo_sim import recording as recordings
from exo_sim.conventions.belonging import of_another_machine
from exo_sim.conventions.commands import LATE_COMMAND
from exo_sim.conventions.filling import slow_for_gas
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.pipeline.sorting import sort
from exo_sim.diagnosis.policy.recordings import FEWEST_IN_COLUMN
from exo_sim.diagnosis.policy.verdicts import GAUGE_ERROR, LATE_ERROR, OBVIOUS_FAULT
from exo_sim.errors import RecordingError
from exo_sim.machine.linkage import linkages
from exo_sim.machine.rig_model import load
from exo_sim.physics.effects import sensor_bias, sensor_delay, sensor_scale
from exo_sim.recording.column_map import ColumnMap
from exo_sim.recording.health import Facts, blanked, check
from exo_sim.recording.reader import Reading
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig, read
from exo_sim.simulation.sensors import seen_through

#: By kind of fault, the name of the finding and what it says.
_FAULTS = {
    "stuck": ("sensor_stuck", "The sensor is stuck for part of the time."),
    "clipped": ("sensor_clipped", "The sensor runs into the end of its range."),
    "gauge": (sensor_bias.EFFECT.name, "The sensor reads gauge pressure where absolute was promised."),
    "unit": (sensor_scale.EFFECT.name, "The column cannot be in the unit that its header names."),
    "range": (sensor_scale.EFFECT.name, "The column leaves the range that its quantity can have."),
    "inconsistent": (sensor_scale.EFFECT.name, "The velocity is not the rate of the position."),
    "constant": ("sensor_stuck", "The sensor shows one value while the machine moves."),
}


def gather(handed_in: Sequence[Path | Reading], rig: Path | Rig, column_map: Path | ColumnMap | None = None) -> MachineData:
    """Read recordings and rig, those of them that are not in memory yet.

    Raises:
        RecordingError, RigError, ModelError: one line each; nothing usable, or columns of another machine.
    """
    rig = rig if isinstance(rig, Rig) else read(rig)
    model = load(rig)
    as_read: list[Recording] = []
    cleaned: list[Recording] = []
    sensors: list[Finding] = []
    remarks: list[str] = []
    checks: list[conventions.Check] = []
    for one in handed_in:
        reading = one if isinstance(one, Reading) else recordings.read(one, column_map)
        _check_belongs(reading.recording, reading.recording.name if isinstance(one, Reading) else one, rig, model)
        settled = conventions.settle(reading.recording, rig, model, reading.findings)
        name = reading.recording.name
        while name in {table.name for table in as_read}:
            name += "'"
        table = replace(settled.recording, name=name)
        checks += [check for check in settled.checks if check not in checks]
        checks += _unread(reading, rig, model)
        remarks += [check.says for check in settled.checks]
        remarks += [finding.says for finding in reading.findings if finding.severity != "info"]
        remarks += [finding.says for finding in slow_for_gas(table, rig)]
        sensors += [_late(check) for check in settled.checks if check.what == LATE_COMMAND]
        as_read.append(table)
        table, corrected = seen_through(table, rig)
        remarks += [f"{table.name}: {column} was put right by what the rig says of its sensor" for column in corrected]
        table, faults, says = _trusted(table, rig, model)
        cleaned.append(table)
        sensors += faults
        remarks += says
    links = linkages(rig, model)
    return sort(
        MachineData(
            rig, model, links, tuple(as_read), tuple(cleaned), {}, {}, tuple(sensors), tuple(remarks), checks=tuple(checks)
        )
    )


def gather_again(data: MachineData, rig: Rig, tables: Sequence[Recording]) -> MachineData:
    """Return the same recordings as another rig of the machine sees them.

    Args:
        data: What was gathered.
        rig: The other rig.
        tables: Recordings in the conventions of the format, as its sensors took them.

    Raises:
        RigError, ModelError: one line each.
    """
    model = load(rig)
    cleaned = tuple(_trusted(seen_through(table, rig)[0], rig, model)[0] for table in tables)
    return sort(MachineData(rig, model, linkages(rig, model), tuple(tables), cleaned, {}, {}, data.sensors))


def _unread(reading: Reading, rig: Rig, model: mujoco.MjModel) -> list[conventions.Check]:
    """Return a check for each column of a part of this machine that the reader had to set aside whole."""
    parts = {*rig.cylinders, *(model.joint(number).name for number in range(model.njnt)), "supply"}
    gone = [f for f in reading.findings if f.severity == "fault" and f.use == "set aside" and f.kind in ("unit", "empty") and not f.rows]
    return [conventions.Check("unread", (f.column,), f.says) for f in gone if f.column.split(".")[0] in parts]


def _late(check: conventions.Check) -> Finding:
    """Return the finding of a command whose column stands on a clock of its own."""
    low, high = (check.value + off for off in (-LATE_ERROR, LATE_ERROR))
    name, says = sensor_delay.EFFECT.name, f"The column comes late. {check.says}."
    return Finding(name, check.columns[0], Kind.SENSOR, says, {"seconds": Estimate(check.value, "s", low, high)}, OBVIOUS_FAULT, 0.0)


def _check_belongs(table: Recording, path: Path | str, rig: Rig, model: mujoco.MjModel) -> None:
    if why := of_another_machine(table, rig, model):
        raise RecordingError(f'"{path}": {why}')


def _trusted(table: Recording, rig: Rig, model: mujoco.MjModel) -> tuple[Recording, list[Finding], list[str]]:
    """Return the recording without what its sensors cannot have seen, a finding for every fault, and what was noticed."""
    columns = dict(table.columns)
    faults: list[Finding] = []
    says: list[str] = []
    for noticed in check(table, Facts.of(rig, model)):
        if noticed.severity == "info":
            continue
        says.append(noticed.says)
        if noticed.severity != "fault" or noticed.column not in columns:
            continue
        values = columns[noticed.column]
        name, what = _FAULTS.get(noticed.kind, ("sensor_fault", noticed.says))
        parameters = {}
        if noticed.kind == "gauge":
            values = values + rig.environment.pressure
            off = -rig.environment.pressure
            parameters = {"value": Estimate(off, "Pa", off - GAUGE_ERROR, off + GAUGE_ERROR)}
        else:
            values = blanked(values, noticed)
        columns[noticed.column] = values
        faults.append(Finding(name, noticed.column, Kind.SENSOR, f"{what} {noticed.says}", parameters, OBVIOUS_FAULT, 0.0))
    kept = {key: values for key, values in columns.items() if np.isfinite(values).sum() > FEWEST_IN_COLUMN}
    return replace(table, columns=kept), faults, says
