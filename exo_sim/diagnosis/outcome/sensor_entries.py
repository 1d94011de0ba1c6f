"""What the improved rig says of sensors: zeros, gains and delays, found or only refitted, on top of what the rig knew of them."""

from __future__ import annotations

from collections.abc import Collection

from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.estimation.uncertainty import interval
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.effects import sensor_bias, sensor_delay, sensor_scale
from exo_sim.rig import EffectEntry, EffectSetting, Rig

#: What is said of a number that was refitted and is no finding.
NO_FINDING = "No finding, a healthy machine shows as much. Fitted together with the numbers above, which predict best with it."

Result = SubsystemResult[SubsystemModel]


def late_entries(data: MachineData, result: Result, calibrated: Collection[str]) -> list[EffectEntry]:
    """Return the delays of sensors and their cards that a healthy machine shows as well.

    Where the pressures of a cylinder were `calibrated` by its gas, its forces say nothing of their delay.
    """
    values = result.final.fit.values
    errors = {q.parameter: error for q, error in result.refitted if q.parameter.endswith(".delay")}
    found = {q.parameter: values[q] for q, _ in result.refitted if q.parameter in errors}
    if not found or (result.where in calibrated and not result.model.calibrates_pressures):
        return []
    late = result.model.late_columns(found, data)
    error = max(errors.values())
    return [
        sensor_entry(Finding(sensor_delay.EFFECT.name, column, Kind.CALIBRATION, NO_FINDING, {"seconds": estimate}, 0.0, 0.0), data.rig)
        for column, value in late.items()
        if value != 0.0 and all(column in table for table in data.as_read)
        for estimate in [Estimate(value, "s", *interval(value, error))]
    ]


def sensor_error_entry(column: str, name: str, parameter: str, value: float, error: float, rig: Rig, balance: str = "N") -> EffectEntry:
    """Return an error of a sensor that was fitted as a nuisance parameter; `balance` is the unit of what acts at the joint."""
    force = balance if column.endswith(".external_force") else "N"  # a load cell on a rod measures newtons where the joint turns, too
    unit = "1" if name == sensor_scale.EFFECT.name else "Pa" if "pressure" in column else force
    estimate = Estimate(value, unit, *interval(value, error))
    return sensor_entry(Finding(name, column, Kind.CALIBRATION, NO_FINDING, {parameter: estimate}, 0.0, 0.0), rig)


def sensor_entry(finding: Finding, rig: Rig) -> EffectEntry:
    """Return what the rig must say of a sensor: what it knew was taken off before anything was found, so both count."""
    known = rig.effect(finding.name, finding.where)
    scale = rig.effect(sensor_scale.EFFECT.name, finding.where)
    turning = any("rad" in e.unit or e.unit == "N*m" for e in finding.parameters.values())

    def both(name: str, found: float) -> float:
        before = known.parameters.get(name, 0.0) if known else 0.0
        if finding.name == sensor_scale.EFFECT.name:
            return (before or 1.0) * found
        return before + found * (scale.parameters["factor"] if scale and finding.name == sensor_bias.EFFECT.name else 1.0)

    values = {name: both(name, e.value) for name, e in finding.parameters.items()}
    intervals = {name: (both(name, e.low), both(name, e.high)) for name, e in finding.parameters.items()}
    return EffectEntry(EffectSetting(finding.name, finding.where, values, turning), intervals, finding.says)
