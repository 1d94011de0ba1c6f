"""What a balance of forces cannot tell apart: scales from masses and from each other, constant forces from errors of sensors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from exo_sim.diagnosis.data.motion_run import Drive, MotionRun
from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.findings import Finding
from exo_sim.diagnosis.nominal_numbers import FORCE_OFFSET, PAYLOAD_MASS, SENSOR_GAIN
from exo_sim.diagnosis.policy.off_nominal import LEAST_OF_TWO_WAYS, SURE, ZERO_OF_RANGE
from exo_sim.physics.declaration import declared
from exo_sim.physics.effects import sensor_bias, sensor_scale


def sensor_error_of(drive: Drive, parameter: FreeParameter, value: float) -> tuple[str, str, str, float] | None:
    """Return column, effect, name and value of the sensor's error that a nuisance parameter stands for; None where it is none.

    A gain is a column's scale; a constant force is the bias of what measures force, else of a pressure. The balance tells only the ratio
    of two scales: where force is measured, that of a pressure is written as the cell's, for the gas feels a pressure too, and may know it
    as the supply's own.

    Args:
        drive: What drives the joint; its levers are the columns.
        parameter: Of the fit.
        value: As fitted.
    """
    columns = sorted(drive.levers, key=lambda column: ("external_force" not in column, "pressure" in column, column))
    if parameter.effect == SENSOR_GAIN:
        if "pressure" in parameter.where and "pressure" not in columns[0]:
            return columns[0], sensor_scale.EFFECT.name, "factor", 1.0 / value
        return parameter.where, sensor_scale.EFFECT.name, "factor", value
    if parameter.effect != FORCE_OFFSET or not columns:
        return None
    return columns[0], sensor_bias.EFFECT.name, "value", -value / float(np.median(drive.levers[columns[0]]))


def scale_instead_of_mass(runs: Sequence[MotionRun], parameter: FreeParameter) -> tuple[str, ...]:
    """Return the scale as what a mass may be instead: one measured force, and all that resists it, in another unit moves another mass.

    Springs and dampers of the MJCF would tell.
    """
    scaled = all(len(run.drive.levers) == 1 and run.inertia.carried is None and not run.passive.force.any() for run in runs)
    return (sensor_scale.EFFECT.name,) if parameter.effect == PAYLOAD_MASS and scaled else ()


def force_of_zeros(drive: Drive) -> float:
    """Return the greatest constant force that the zero of a pressure sensor may make, by data sheets [N or N m]; 0 without pressures."""
    forces = [
        float(np.median(np.abs(drive.levers[column]))) * float(np.max(np.abs(signal)))
        for column, signal in drive.signals.items() if "pressure" in column
    ]  # fmt: skip
    return ZERO_OF_RANGE * max(forces, default=0.0)


def constant_force_of_zeros(runs: Sequence[MotionRun]) -> float:
    """Return the greatest constant force that zeros of pressure sensors may make where friction acts, in any recording [N or N m]."""
    return max(force_of_zeros(run.drive) / run.drive.usual_arm for run in runs)


def friction_beside_constant_force(
    findings: Sequence[Finding], fit: Fit, runs: Sequence[MotionRun]
) -> Mapping[tuple[str, str], tuple[str, ...]]:
    """Return by finding the friction that it may be instead, beside a constant force: a force sensor's bias, or what closed the balance.

    Friction of two directions is that of one beside a constant force: no motion tells the two apart, however great the odds of either. That
    may be the zero of a pressure sensor, where this may be as large; and where no seal differs by so much, any force that the rig lacks.

    Args:
        findings: Of a balance.
        fit: Of its numbers.
        runs: The balance in every recording: the greatest pressure of all of them says the range of its sensors.
    """
    of_zeros = constant_force_of_zeros(runs)
    names = {finding.name for finding in findings}
    beside = {one.name: one.identification.twins.beside_constant for one in declared().values()}
    twins = {name: twin for name, twin in beside.items() if twin in names}
    offsets = [q for q in fit.values if q.effect == FORCE_OFFSET]
    moved = any(abs(fit.values[q] - q.prior[0]) > SURE * q.prior[1] for q in offsets if q.prior)
    found = {
        f.at: tuple(name for name, base in twins.items() if base == f.name or f.name == sensor_bias.EFFECT.name)
        for f in findings
        if twins and ((f.name == sensor_bias.EFFECT.name and f.where.endswith(".external_force")) or (moved and f.name in twins.values()))
    }
    return found | {f.at: (beside[f.name],) for f in findings if beside.get(f.name) and _may_be_a_force(f, beside[f.name], of_zeros)}


def _may_be_a_force(finding: Finding, single: str, of_zeros: float) -> bool:
    """Return whether friction of two directions may be that of one, `single`, beside a constant force; not where none is declared.

    Args:
        finding: Of friction of two directions.
        single: The effect that is friction of one.
        of_zeros: The greatest constant force that zeros of pressure sensors may make [N or N m].
    """
    shared = dict(declared()[finding.name].absorbs).get(single, ())
    ways = [finding.parameters[name].value for name, _ in shared if name in finding.parameters]
    return bool(ways) and (0.5 * (max(ways) - min(ways)) <= of_zeros or min(ways) < LEAST_OF_TWO_WAYS * max(ways))
