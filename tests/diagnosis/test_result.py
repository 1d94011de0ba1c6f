"""The result of a diagnosis: exit status, the JSON of the contract, and what its errors are called."""

from __future__ import annotations

import json

import pytest

from exo_sim.diagnosis.findings import Estimate, Finding, Kind, NextExperiment, SignalFit
from exo_sim.diagnosis.result import SCHEMA, Diagnosis, Verdict

LEAK = Finding("piston_leakage", "piston", Kind.MISSING_PHYSICS, "It leaks.", {"area": Estimate(3e-8, "m^2", 2e-8, 4e-8)}, 1.0, 0.41237)


@pytest.mark.parametrize(("verdict", "status"), [("consistent", 0), ("calibration", 0), ("mismatch", 3), ("undetermined", 4)])
def test_the_exit_status_of_a_verdict(verdict: str, status: int) -> None:
    assert Verdict(verdict).exit_status == status == Diagnosis(Verdict(verdict), (), "bench").exit_status


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

    assert "0.5 s predictions, motion as recorded" in measure("piston.pressure_1")  # `compare` predicts the motion as well
    assert "0.5 s predictions" in measure("piston.pressure_1") and "balance" not in measure("piston.pressure_1")
    assert "0.5 s" not in measure("slide.force_balance")
    assert "0.5 s predictions" in measure("piston.pressure_1", "slide.force_balance") and "balance" in measure("a", "b.force_balance")
