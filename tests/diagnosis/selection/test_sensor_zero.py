"""The zero of a pressure sensor: how surely it is known, and when it is no healthy one's."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.policy.acceptance import SURELY_MORE
from exo_sim.diagnosis.policy.healthy import ZERO_MODEL
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.sensor_zero import error_of, is_faulty, zeros_of_forces_within, zeros_within
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult

ZERO = FreeParameter("sensor_zero", "piston.pressure_1", "pressure_1.bias", "Pa", Target.SENSOR, 500.0, -1e4, 1e4, (0.0, 500.0))
WIDTH = FreeParameter("valve_deadband", "piston", "width", "1", Target.CYLINDER, 0.0025, 0.0, 0.01, (0.0, 0.0025))


class Gas(waves.Waves):
    """Whose equations may be wrong by 1 kPa in a healthy machine."""

    structural_error = 1000.0  # type: ignore[assignment]


def result(value: float, parameter: FreeParameter = ZERO) -> SubsystemResult[waves.Waves]:
    model = Gas()
    final = FittedModel((), Fit((parameter,), {parameter: value}, np.zeros(4), np.zeros((4, 1))))
    return SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final)


@pytest.mark.parametrize(("value", "faulty"), [(300.0, False), (-2340.0, False), (8000.0, True), (-8000.0, True)])
def test_a_zero_is_faulty_where_it_is_surely_further_off_than_healthy_ones(value: float, faulty: bool) -> None:
    assert is_faulty(result(value), ZERO, 50.0) is faulty
    assert not is_faulty(replace(result(value), has_unknown=True), ZERO, 50.0)


def test_only_the_zero_of_a_sensor_stands_still_as_errors_of_a_model_do() -> None:
    one = result(2e-3, parameter=WIDTH)
    assert error_of(one, WIDTH, 1e-4) == 1e-4 and not is_faulty(one, WIDTH, 1e-4)
    assert error_of(result(0.0), ZERO, 50.0) == pytest.approx(math.hypot(50.0, 1000.0 * ZERO_MODEL))


def test_a_zero_can_be_off_by_what_was_fitted_and_by_its_error_and_by_any_where_something_is_unknown(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one = result(300.0)
    monkeypatch.setattr(one.fits, "standard_errors", lambda model: {ZERO: 50.0, WIDTH: 1e-4})
    end = replace(one.final, fit=replace(one.final.fit, values={ZERO: 300.0, WIDTH: 2e-3}))
    one = replace(one, search=SearchResult(end, end))
    assert zeros_within(one) == {"piston.pressure_1": pytest.approx(300.0 + SURELY_MORE * 1000.0 * ZERO_MODEL, rel=0.05)}
    assert zeros_within(replace(one, has_unknown=True)) == {}
    assert zeros_within(replace(one, search=SearchResult(end, end, interrupted=True))) == {}


class Forces(waves.Waves):
    """A balance whose constant force is the zero of a load cell at a lever of 2."""

    def as_sensor_error(self, parameter: FreeParameter, value: float) -> tuple[str, str, str, float] | None:
        return ("piston.force", "sensor_bias", "value", -0.5 * value) if parameter is OFFSET else None


OFFSET = FreeParameter("offset", "slide", "offset", "N", Target.SENSOR, 1.0, -1e6, 1e6, (0.0, 1.0))
CELL = FreeParameter("sensor_bias", "piston.force", "piston.force.bias", "N", Target.SENSOR, 1.0, -1e6, 1e6)


def test_a_load_cell_s_zero_can_be_off_by_what_its_joint_s_balance_found_and_refitted_together(monkeypatch: pytest.MonkeyPatch) -> None:
    model, errors = Forces(), {OFFSET: 0.4, CELL: 0.3, WIDTH: 1e-4}
    end = FittedModel((), Fit(tuple(errors), {OFFSET: 2.0, CELL: 7.0, WIDTH: 2e-3}, np.zeros(4), np.zeros((4, 3))))
    one = SubsystemResult("slide", model, ModelFits(model, ()), SearchResult(end, end), end)
    monkeypatch.setattr(one.fits, "standard_errors", lambda model: errors)
    assert zeros_of_forces_within(one) == {"piston.force": pytest.approx(6.0 + SURELY_MORE * math.hypot(0.2, 0.3))}
    assert zeros_of_forces_within(replace(one, has_unknown=True)) == {}
