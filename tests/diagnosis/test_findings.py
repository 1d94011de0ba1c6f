"""Findings as plain records: confidence, each place of a finding, and the order in which they are listed."""

from __future__ import annotations

import math

import pytest

from exo_sim.diagnosis.findings import Estimate, Finding, Kind, SignalFit, in_order
from exo_sim.diagnosis.policy.verdicts import MOST_CONFIDENT

LEAK = Finding("piston_leakage", "piston", Kind.MISSING_PHYSICS, "It leaks.", {"area": Estimate(3e-8, "m^2", 2e-8, 4e-8)}, 1.0, 0.41237)


@pytest.mark.parametrize(("odds", "confidence"), [(0.0, 0.5), (1.0, 10.0 / 11.0), (-1.0, 1.0 / 11.0), (9000.0, float(MOST_CONFIDENT))])
def test_confidence_follows_from_the_odds_and_is_never_more_than_experience_bears(odds: float, confidence: float) -> None:
    assert Finding("a", "b", Kind.UNKNOWN, "", {}, odds, 0.0).confidence == pytest.approx(min(confidence, float(MOST_CONFIDENT)))


def test_a_probability_that_was_weighed_goes_before_the_odds() -> None:
    assert Finding("a", "b", Kind.UNKNOWN, "", {}, 9.0, 0.0, probability=0.7).confidence == 0.7


def test_an_error_of_a_card_is_a_finding_at_each_column() -> None:
    late = Finding("sensor_delay", "piston.pressure_1", Kind.SENSOR, "", {}, 9.0, 0.0, also=("piston.pressure_2",))
    assert [(one.where, one.also) for one in late.at_each_place()] == [("piston.pressure_1", ()), ("piston.pressure_2", ())]


def test_the_largest_error_of_a_signal_is_never_zero_or_nothing() -> None:
    assert SignalFit("Pa", 3.0, 2.0, 1.0).largest == 3.0
    assert SignalFit("Pa", math.nan, 0.0, 0.0).largest == 1.0


def test_physics_comes_by_its_cost_whether_it_has_a_name_or_not_then_sensors_and_numbers() -> None:
    def one(kind: Kind, cost: float) -> Finding:
        return Finding(f"{kind} {cost}", "piston", kind, "", {}, 9.0, 0.0, cost=cost)

    dear, cheap = one(Kind.UNKNOWN, 0.3), one(Kind.MISSING_PHYSICS, 0.1)
    late, off = one(Kind.SENSOR, 0.9), one(Kind.CALIBRATION, 0.0)
    assert in_order([off, late, cheap, dear]) == [dear, cheap, late, off]
