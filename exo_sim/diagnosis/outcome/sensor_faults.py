"""Zeros of pressure sensors and scales of what feels forces that a fit moved: how surely, and whether further than healthy ones are off."""

from __future__ import annotations

import math
from collections.abc import Sequence

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.estimation.uncertainty import bounded_interval, interval
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.policy.healthy import ZEROS
from exo_sim.diagnosis.policy.priors import PRESSURE_ZERO
from exo_sim.diagnosis.policy.probability import UNTESTED
from exo_sim.diagnosis.selection.nuisances_beyond_prior import is_beyond_data_sheet
from exo_sim.diagnosis.selection.sensor_zero import error_of, is_faulty
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.effects import sensor_bias, sensor_scale

Result = SubsystemResult[SubsystemModel]


def faulty_zeros(results: Sequence[Result], findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return a finding for every pressure sensor whose zero is surely further off than a healthy one's and that is not reported yet.

    Args:
        results: Of all subsystems.
        findings: What is reported already.
    """
    reported = {finding.at for finding in findings}
    found = []
    for one in results:
        for q, error in one.refitted:
            if is_faulty(one, q, error) and (sensor_bias.EFFECT.name, q.where) not in reported:
                value, spread = one.final.fit.values[q], error_of(one, q, error)
                odds = 0.5 * ((abs(value) - ZEROS * PRESSURE_ZERO) / spread) ** 2 / math.log(10.0)
                estimate = Estimate(value, q.unit, *bounded_interval(q, value, spread))
                name, says = sensor_bias.EFFECT.name, wording.says(sensor_bias.EFFECT.name)
                found.append(Finding(name, q.where, Kind.SENSOR, says, {"value": estimate}, odds, 0.0, probability=float(UNTESTED)))
    return tuple(found)


def faulty_scales(results: Sequence[Result], findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return a finding for every scale that a balance of forces puts surely further off than any data sheet allows.

    Arguments as of `faulty_zeros`. Of a balance with something unknown in it nothing is sure.
    """
    reported = {finding.at for finding in findings}
    found = {}
    for one in results:
        for q, error in () if one.has_unknown or one.is_empty else one.refitted:
            value = one.final.fit.values[q]
            said = one.model.as_sensor_error(q, value)
            if said is None or said[1] != sensor_scale.EFFECT.name or not is_beyond_data_sheet(q, value, error):
                continue
            where, name, called, factor = said
            estimate = Estimate(factor, "1", *interval(factor, error * factor / value))
            if (name, where) not in reported:
                odds = 0.5 * ((value - 1.0) / error) ** 2 / math.log(10.0)
                found[where] = Finding(
                    name, where, Kind.SENSOR, wording.says(name), {called: estimate}, odds, 0.0, probability=float(UNTESTED)
                )
    return tuple(found.values())
