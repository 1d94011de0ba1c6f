"""What shows beyond doubt but is too small to matter is listed with its number, once, and not where something has no name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis import waves

from exo_sim.diagnosis.estimation.least_squares import Fit
from exo_sim.diagnosis.estimation.parameters import FreeParameter, Target
from exo_sim.diagnosis.findings import Finding, Kind
from exo_sim.diagnosis.outcome.small_findings import small_findings
from exo_sim.diagnosis.selection.fitted_model import FittedModel, SearchResult
from exo_sim.diagnosis.selection.model_fits import ModelFits
from exo_sim.diagnosis.selection.subsystem_result import SubsystemResult

WIDTH = FreeParameter("valve_deadband", "piston", "width", "1", Target.CYLINDER, 0.0025, 0.0, 0.01, (0.0, 0.0025))
VALVE = FreeParameter("flow_capacity", "piston", "valve_area", "1", Target.FACTOR, 0.1, 0.05, 10.0, (1.0, 0.1), neutral=1.0)
ZERO = FreeParameter("sensor_zero", "piston.pressure_1", "pressure_1.bias", "Pa", Target.SENSOR, 500.0, -1e4, 1e4, (0.0, 500.0))


def result(*refitted: tuple[FreeParameter, float, float]) -> SubsystemResult[waves.Waves]:
    """Return a result with these parameters refitted: value and standard error."""
    model, values = waves.Waves(), {parameter: value for parameter, value, _ in refitted}
    final = FittedModel((), Fit(tuple(values), values, np.zeros(4), np.zeros((4, len(values)))))
    found = SubsystemResult("piston", model, ModelFits(model, ()), SearchResult(final, final), final)
    return replace(found, refitted=tuple((parameter, error) for parameter, _, error in refitted))


def test_each_is_told_with_name_place_kind_and_number() -> None:
    found = small_findings([result((WIDTH, 2.1e-3, 1e-4), (VALVE, 0.99, 1e-3), (ZERO, 300.0, 20.0))], ())
    reported = {(one.name, one.where, one.kind): next(iter(one.parameters.items())) for one in found}
    assert set(reported) == {
        ("valve_deadband", "piston", Kind.MISSING_PHYSICS),
        ("flow_capacity", "piston", Kind.CALIBRATION),
        ("sensor_bias", "piston.pressure_1", Kind.SENSOR),
    }
    name, estimate = reported["valve_deadband", "piston", Kind.MISSING_PHYSICS]
    assert name == "width" and estimate.low < estimate.value == 2.1e-3 < estimate.high


def test_a_number_of_an_effect_that_the_rig_has_is_no_surer_than_its_law() -> None:
    """A leak comes out a seventh off where its gap is an orifice, and a valve's lag by the clocks of two cards, whatever the noise."""
    leak = FreeParameter("piston_leakage", "piston", "laminar", "kg/(s Pa^2)", Target.CYLINDER, 1e-16, 0.0, 1e-12, (1e-16, 1e-17))
    lag = FreeParameter("valve_lag", "piston", "time_constant", "s", Target.CYLINDER, 1e-3, 0.0, 0.5, (3.4e-3, 1.5e-3))
    found = {one.name: one.parameters for one in small_findings([result((leak, 1.2e-16, 1e-18), (lag, 5.4e-3, 1e-5))], ())}
    size, time = found["piston_leakage"]["laminar"], found["valve_lag"]["time_constant"]
    assert size.low < 1e-16 and size.high > 1.4e-16
    assert time.low < 3.4e-3 and time.high > 7.5e-3


@pytest.mark.parametrize(("value", "error"), [(4e-4, 1e-4), (0.0, 1e-9)])
def test_what_is_not_beyond_doubt_is_not(value: float, error: float) -> None:
    assert small_findings([result((WIDTH, value, error))], ()) == ()


def test_nor_what_is_a_finding_or_beside_something_unknown() -> None:
    plain = result((WIDTH, 2.1e-3, 1e-4))
    assert small_findings([plain], [Finding("valve_deadband", "piston", Kind.MISSING_PHYSICS, "", {}, 9.0, 0.5)]) == ()
    assert small_findings([replace(plain, has_unknown=True)], ()) == ()
