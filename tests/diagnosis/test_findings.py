"""The result as plain records: exit status, confidence, each place of a finding, and the JSON of the contract."""

from __future__ import annotations

import json
import math

import pytest

from exo_sim.diagnosis.findings import SCHEMA, Diagnosis, Estimate, Finding, Kind, NextExperiment, SignalFit, Verdict, in_order
from exo_sim.diagnosis.policy.verdicts import MOST_CONFIDENT

LEAK = Finding("piston_leakage", "piston", Kind.MISSING_PHYSICS, "It leaks.", {"area": Estimate(3e-8, "m^2", 2e-8, 4e-8)}, 1.0, 0.41237)


@pytest.mark.parametrize(("verdict", "status"), [("consistent", 0), ("calibration", 0), ("mismatch", 3), ("undetermined", 4)])
def test_the_exit_status_of_a_verdict(verdict: str, status: int) -> None:
    assert Verdict(verdict).exit_status == status == Diagnosis(Verdict(verdict), (), "bench").exit_status


@pytest.mark.parametrize(("odds", "confidence"), [(0.0, 0.5), (1.0, 10.0 / 11.0), (-1.0, 1.0 / 11.0), (9000.0, float(MOST_CONFIDENT))])
def test_confidence_follows_from_the_odds_and_is_never_more_than_experience_bears(odds: float, confidence: float) -> None:
    assert Finding("a", "b", Kind.UNKNOWN, "", {}, odds, 0.0).confidence == pytest.approx(min(confidence, float(MOST_CONFIDENT)))


def test_a_probability_that_was_weighed_goes_before_the_odds() -> None:
    assert Finding("a", "b", Kind.UNKNOWN, "", {}, 9.0, 0.0, probability=0.7).confidence == 0.7


def test_an_error_of_a_card_is_a_finding_at_each_column() -> None:
    late = Finding("sensor_delay", "piston.pressure_1", Kind.SENSOR, "", {}, 9.0, 0.0, also=("piston.pressure_2",))
    assert [(one.where, one.also) for one in late.at_each_place()] == [("piston.pressure_1", ()), ("piston.pressure_2", ())]


def test_json_has_the_schema_and_goes_there_and_back() -> None:
    found = Diagnosis(
        Verdict.MISMATCH, ("r",), "bench", effects=(LEAK,), signals={"piston.pressure_1": SignalFit("Pa", 900.0, 200.0, 150.0)},
        next_experiment=NextExperiment("why", "do", ("piston_leakage",)),
    ).as_dict()  # fmt: skip
    again = json.loads(json.dumps(found))
    assert again == found and again["schema"] == SCHEMA
    (effect,) = again["effects"]
    assert effect["parameters"]["area"] == {"value": 3e-8, "unit": "m^2", "low": 2e-8, "high": 4e-8}
    assert effect["evidence"] == {"log10_odds": 1.0, "probability": 0.909, "held_out_error_drop": 0.4124, "cost": 0.0}
    assert "stopped" not in again and "curve" not in effect
    assert Diagnosis(Verdict.CONSISTENT, (), "bench", stopped=True).as_dict()["stopped"] is True


def test_the_measure_says_what_the_errors_are() -> None:
    def measure(*names: str) -> str:
        return Diagnosis(Verdict.CONSISTENT, (), "b", signals={name: SignalFit("N", 1.0, 1.0, 1.0) for name in names}).measure

    assert "0.5 s predictions" in measure("piston.pressure_1") and "balance" not in measure("piston.pressure_1")
    assert "0.5 s" not in measure("slide.force_balance")
    assert "0.5 s predictions" in measure("piston.pressure_1", "slide.force_balance") and "balance" in measure("a", "b.force_balance")


def test_the_largest_error_of_a_signal_is_never_zero_or_nothing() -> None:
    assert SignalFit("Pa", 3.0, 2.0, 1.0).largest == 3.0
    assert SignalFit("Pa", math.nan, 0.0, 0.0).largest == 1.0


def test_physics_comes_by_its_cost_whether_it_has_a_name_or_not_then_sensors_and_numbers() -> None:
    def one(kind: Kind, cost: float) -> Finding:
        return Finding(f"{kind} {cost}", "piston", kind, "", {}, 9.0, 0.0, cost=cost)

    dear, cheap = one(Kind.UNKNOWN, 0.3), one(Kind.MISSING_PHYSICS, 0.1)
    late, off = one(Kind.SENSOR, 0.9), one(Kind.CALIBRATION, 0.0)
    assert in_order([off, late, cheap, dear]) == [dear, cheap, late, off]
