"""A valve command that was recorded with the wrong sign."""

from __future__ import annotations

from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.physics.effects import sensor_scale

_OPPOSITE = Estimate(-1.0, "1", -1.0, -1.0)


def reversed_command(cylinder: str) -> Finding:
    """Return the finding of a valve command with the wrong sign."""
    says = "The valve command has the wrong sign: its opposite moves the pressures as recorded."
    return Finding(sensor_scale.EFFECT.name, f"{cylinder}.valve_command", Kind.SENSOR, says, {"factor": _OPPOSITE}, 100.0, 0.9)


def is_reversed_command(finding: Finding) -> bool:
    """Return whether a finding is of a valve command with the wrong sign."""
    return finding.where.endswith(".valve_command") and finding.parameters.get("factor") == _OPPOSITE
