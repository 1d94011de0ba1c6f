"""A valve command with the wrong sign is a finding of its own, and no other gain of a command is it."""

from __future__ import annotations

from dataclasses import replace

from exo_sim.diagnosis.data.command_sign import is_reversed_command, reversed_command
from exo_sim.diagnosis.findings import Estimate, Kind


def test_it_is_an_error_of_the_commands_sensor_with_a_factor_of_minus_one() -> None:
    finding = reversed_command("piston")
    assert (finding.name, finding.where, finding.kind) == ("sensor_scale", "piston.valve_command", Kind.SENSOR)
    assert finding.parameters["factor"].value == -1.0 and finding.confidence > 0.9
    assert is_reversed_command(finding)


def test_another_gain_or_another_column_is_not_it() -> None:
    finding = reversed_command("piston")
    assert not is_reversed_command(replace(finding, parameters={"factor": Estimate(-0.9, "1", -1.0, -0.8)}))
    assert not is_reversed_command(replace(finding, where="piston.pressure_1"))
