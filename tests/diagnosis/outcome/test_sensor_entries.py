"""What the improved rig says of a sensor, on top of what the rig knew of it."""

from __future__ import annotations

from dataclasses import replace

import benches
import pytest

from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.outcome.sensor_entries import NO_FINDING, sensor_entry, sensor_error_entry
from exo_sim.physics.effects import sensor_bias
from exo_sim.rig import EffectSetting, Rig
from exo_sim.rig.effect_text import unit_of

COLUMN = "piston.pressure_1"


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    return benches.bench(tmp_path_factory.mktemp("sensors"))


def bias(pascal: float) -> Finding:
    return Finding("sensor_bias", COLUMN, Kind.SENSOR, "off", {"value": Estimate(pascal, "Pa", pascal - 10.0, pascal + 10.0)}, 1.0, 1.0)


def test_a_zero_that_the_rig_knew_adds_up_with_the_one_that_was_found(rig: Rig) -> None:
    known = replace(rig, effects=(*rig.effects, EffectSetting("sensor_bias", COLUMN, {"value": 300.0})))
    entry = sensor_entry(bias(200.0), known)
    assert entry.setting.parameters == {"value": 500.0}
    assert entry.intervals == {"value": (490.0, 510.0)}


def test_gains_multiply_and_a_zero_passes_the_gain_that_the_rig_knew(rig: Rig) -> None:
    known = replace(rig, effects=(*rig.effects, EffectSetting("sensor_scale", COLUMN, {"factor": 1.1})))
    gain = Finding("sensor_scale", COLUMN, Kind.SENSOR, "off", {"factor": Estimate(1.2, "1", 1.2, 1.2)}, 1.0, 1.0)
    assert sensor_entry(gain, known).setting.parameters["factor"] == pytest.approx(1.32)
    assert sensor_entry(bias(200.0), known).setting.parameters["value"] == pytest.approx(220.0)


def test_what_was_only_refitted_is_said_to_be_no_finding(rig: Rig) -> None:
    entry = sensor_error_entry(COLUMN, "sensor_bias", "value", 50.0, 5.0, rig)
    assert entry.setting.name == "sensor_bias"
    assert NO_FINDING in repr(entry)


@pytest.mark.parametrize(
    ("column", "balance", "unit"),
    [("swing.external_force", "N*m", "N*m"), ("slide.external_force", "N", "N"), ("knee.force", "N*m", "N"), (COLUMN, "N*m", "Pa")],
)
def test_the_zero_of_a_sensor_is_in_what_the_sensor_measures(rig: Rig, column: str, balance: str, unit: str) -> None:
    setting = sensor_error_entry(column, "sensor_bias", "value", 0.5, 0.1, rig, balance).setting
    assert unit_of(sensor_bias.EFFECT.parameters[0], setting) == unit
