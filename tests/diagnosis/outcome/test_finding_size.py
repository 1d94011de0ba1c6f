"""How far the numbers of a finding lie from nil."""

from __future__ import annotations

import math

import pytest

from exo_sim.diagnosis.findings import Estimate, Finding, Kind
from exo_sim.diagnosis.outcome.finding_size import errors_from_nil, may_be_nil


def finding(name: str, **parameters: Estimate) -> Finding:
    return Finding(name, "piston", Kind.MISSING_PHYSICS, "", parameters, 9.0, 0.0)


@pytest.mark.parametrize(("value", "low", "high", "nil", "errors"), [(30.0, 0.0, 60.0, True, 1.96), (30.0, 20.0, 40.0, False, 5.88)])
def test_a_number_lies_so_many_standard_errors_from_nil(value: float, low: float, high: float, nil: bool, errors: float) -> None:
    one = finding("quadratic_drag", coefficient=Estimate(value, "N s^2/m^2", low, high))
    assert may_be_nil(one) is nil and errors_from_nil(one) == pytest.approx(errors, rel=1e-3)


def test_of_several_the_one_farthest_from_nil_counts() -> None:
    parts = {"conductance_1": Estimate(0.3, "W/K", 0.0, 0.6), "conductance_2": Estimate(0.6, "W/K", 0.3, 0.9)}
    one = finding("wall_heat_transfer", **parts)
    assert not may_be_nil(one) and errors_from_nil(one) == pytest.approx(3.92, rel=1e-3)


def test_a_finding_without_numbers_is_not_nil() -> None:
    assert not may_be_nil(finding("quadratic_drag")) and errors_from_nil(finding("quadratic_drag")) == math.inf


def test_how_far_a_number_may_lie_beyond_its_value_does_not_bring_it_nearer_to_nil() -> None:
    one = finding("stribeck_friction", breakaway=Estimate(40.0, "N", 20.0, 400.0))
    assert errors_from_nil(one) == pytest.approx(40.0 / 20.0 * 1.96, rel=1e-3)
