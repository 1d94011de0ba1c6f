"""Zeros of pressure sensors: what is more than a healthy one shows is a finding, and errors of the model move them as well."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Finding, Kind
from exo_sim.diagnosis.outcome.sensor_faults import faulty_scales, faulty_zeros
from exo_sim.diagnosis.outcome.small_findings import small_findings
from exo_sim.diagnosis.policy.healthy import ZERO_MODEL, ZEROS
from exo_sim.diagnosis.policy.priors import PRESSURE_ZERO
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult

ZERO = FreeParameter("sensor_zero", "piston.pressure_1", "pressure_1.bias", "Pa", Target.SENSOR, 500.0, -1e4, 1e4, (0.0, 500.0))


class Gas(waves.Waves):
    """Whose equations may be wrong by 1 kPa in a healthy machine."""

    structural_error = 1000.0  # type: ignore[assignment]


def result(value: float, model: waves.Waves | None = None, parameter: FreeParameter = ZERO) -> SubsystemResult[waves.Waves]:
    model = model or Gas()
    final = FittedModel((), Fit((parameter,), {parameter: value}, np.zeros(4), np.zeros((4, 1))))
    found = SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final)
    return replace(found, refitted=((parameter, 50.0),))


@pytest.mark.parametrize(("value", "faulty"), [(300.0, False), (-2340.0, False), (8000.0, True), (-8000.0, True)])
def test_a_zero_is_a_finding_where_it_is_surely_further_off_than_healthy_ones(value: float, faulty: bool) -> None:
    one = result(value)
    found = faulty_zeros([one], ())
    assert [f.where for f in found] == ["piston.pressure_1"] * faulty
    for each in found:
        estimate, spread = each.parameters["value"], math.hypot(50.0, 1000.0 * ZERO_MODEL)
        assert each.kind is Kind.SENSOR and each.name == "sensor_bias" and estimate.value == value
        assert estimate.high - estimate.low == pytest.approx(min(2 * 1.96 * spread, 1e4 - abs(value) + 1.96 * spread), rel=1e-3)
        assert each.log10_odds == pytest.approx(0.5 * ((8000.0 - ZEROS * PRESSURE_ZERO) / spread) ** 2 / math.log(10.0))


def test_what_errors_of_the_model_move_as_far_is_neither_a_finding_nor_beyond_doubt() -> None:
    assert small_findings([result(-2340.0)], ()) == () and small_findings([result(-2340.0, waves.Waves())], ()) != ()


def test_it_is_said_once_and_not_beside_what_is_unknown() -> None:
    said = Finding("sensor_bias", "piston.pressure_1", Kind.SENSOR, "", {}, 9.0, 0.0)
    assert faulty_zeros([result(8000.0)], [said]) == () and faulty_zeros([replace(result(8000.0), has_unknown=True)], ()) == ()


CELL = FreeParameter("sensor_gain", "piston.force", "piston.force.scale", "1", Target.SENSOR, 0.012, 0.8, 1.25, (1.0, 0.012), neutral=1.0)


class Forces(waves.Waves):
    """A balance that feels a load cell."""

    def as_sensor_error(self, parameter: FreeParameter, value: float) -> tuple[str, str, str, float] | None:
        return ("piston.force", "sensor_scale", "factor", value) if parameter == CELL else None


@pytest.mark.parametrize(("factor", "faulty"), [(1.0146, False), (1.056, True), (0.95, True), (1.043, False)])
def test_a_load_cell_that_is_off_by_more_than_any_data_sheet_allows_is_a_finding(factor: float, faulty: bool) -> None:
    one = replace(result(factor, Forces(), CELL), refitted=((CELL, 1e-3),))
    found = faulty_scales([one], ())
    assert [(each.name, each.where, each.kind) for each in found] == [("sensor_scale", "piston.force", Kind.SENSOR)] * faulty
    for each in found:
        assert each.parameters["factor"].low < factor < each.parameters["factor"].high
        assert faulty_scales([one], [each]) == ()
    assert faulty_scales([replace(one, has_unknown=True)], ()) == faulty_scales([result(1.2)], ()) == ()
