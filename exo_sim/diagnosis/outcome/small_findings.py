"""What the data show beyond doubt, but too little of it to matter: refitted numbers that no healthy machine's error explains away."""

from __future__ import annotations

from collections.abc import Sequence

from exo_sim.diagnosis import wording
from exo_sim.diagnosis.estimation.parameters import FreeParameter
from exo_sim.diagnosis.estimation.uncertainty import bounded_interval
from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.nominal_numbers import ZERO
from exo_sim.diagnosis.outcome.rig_corrections import REFITTED
from exo_sim.diagnosis.policy.off_nominal import BEYOND_DOUBT, MODEL_SHARE
from exo_sim.diagnosis.selection.nuisance_calibration import error_of_law, is_declared
from exo_sim.diagnosis.selection.sensor_zero import error_of
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult
from exo_sim.diagnosis.subsystem_model import SubsystemModel
from exo_sim.physics.effects import sensor_bias


def small_findings(results: Sequence[SubsystemResult[SubsystemModel]], findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """Return an entry for every number that surely differs from its nominal value and is no finding.

    A subsystem in which something has no name gives none: its numbers may stand for that.

    Args:
        results: Of all subsystems.
        findings: What is reported already.
    """
    reported = {finding.at for finding in findings}
    found: dict[tuple[str, str], Finding] = {}
    for one in results:
        for parameter, error in () if one.has_unknown or one.is_empty else one.refitted:
            entry = _entry(one, parameter, error_of(one, parameter, error))
            if entry is not None and (entry.name, entry.where) not in reported:
                at = entry.name, entry.where
                before = found.get(at)
                parameters = {**(before.parameters if before else {}), **entry.parameters}
                found[at] = Finding(*at, entry.kind, entry.says, parameters, 0.0, 0.0)
    return tuple(found.values())


def _entry(one: SubsystemResult[SubsystemModel], parameter: FreeParameter, error: float) -> Finding | None:
    if parameter.prior is None:
        return None
    value, (nominal, _) = one.final.fit.values[parameter], parameter.prior
    if abs(value - nominal) <= BEYOND_DOUBT * max(error, MODEL_SHARE * abs(nominal)):
        return None
    name, where, called, unit, kind = parameter.effect, parameter.where, parameter.parameter, parameter.unit, Kind.CALIBRATION
    by_force = one.model.as_sensor_error(parameter, value)
    known = is_declared(name) and nominal != 0.0 and by_force is None
    low, high = bounded_interval(parameter, value, error_of_law(parameter, value, error) if known else error)
    if by_force is not None:
        where, name, called, shown = by_force
        scale = shown / value if name == sensor_bias.EFFECT.name and value else 1.0
        if name != sensor_bias.EFFECT.name and shown != value:  # a ratio of two scales, said of the other column
            low, high = shown * low / value, shown * high / value
        low, high = sorted((scale * low, scale * high))
        value, kind = shown, Kind.SENSOR
        unit = "1" if name != sensor_bias.EFFECT.name else "Pa" if "pressure" in where else unit
    elif name == ZERO:
        name, called, kind = sensor_bias.EFFECT.name, "value", Kind.SENSOR
    elif is_declared(name):
        kind = Kind.MISSING_PHYSICS if nominal == 0.0 else Kind.CALIBRATION
    elif name not in REFITTED:
        return None
    return Finding(name, where, kind, wording.small(name, kind is Kind.CALIBRATION), {called: Estimate(value, unit, low, high)}, 0.0, 0.0)
