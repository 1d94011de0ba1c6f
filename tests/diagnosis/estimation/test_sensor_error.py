"""An error of a sensor as a candidate: one number, off at what a perfect sensor has, a finding only beyond a healthy one."""

from __future__ import annotations

import pytest

from exo_sim.diagnosis.estimation.parameters import Target
from exo_sim.diagnosis.estimation.sensor_error import sensor_error
from exo_sim.diagnosis.findings import Kind
from exo_sim.physics.effects import sensor_bias, sensor_scale


def test_a_bias_starts_a_typical_size_away_from_zero() -> None:
    one = sensor_error(sensor_bias.EFFECT, "piston.pressure_1", "pressure_1.bias", "Pa", 500.0, (-1e4, 1e4), 2000.0)
    (free,) = one.parameters
    assert one.at == ("sensor_bias", "piston.pressure_1") and one.kind is Kind.SENSOR and one.form == "value"
    assert one.starts == ((500.0,),) and free.start == 0.0
    assert (free.low, free.high, free.healthy_limit, free.target) == (-1e4, 1e4, 2000.0, Target.SENSOR)


def test_a_gain_starts_beside_one() -> None:
    one = sensor_error(sensor_scale.EFFECT, "piston.pressure_1", "pressure_1.scale", "1", 0.05, (0.5, 2.0), 0.02, neutral=1.0)
    assert one.starts == (pytest.approx((1.05,)),) and one.parameters[0].start == 1.0
