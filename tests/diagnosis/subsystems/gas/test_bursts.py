"""What is too fast for the rows of a gas's fit: a sensor's noise is even, a pressure that rings comes in bursts."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.diagnosis.policy.healthy import BURSTS
from exo_sim.diagnosis.subsystems.gas.bursts import burst_ratio, fast_errors
from exo_sim.diagnosis.subsystems.gas.rows import Rows
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions


@given(st.integers(0, 10_000), st.floats(1.0, 1e4), st.floats(0.3, 2.0))
def test_an_even_noise_does_not_tremble_whatever_its_level_was_taken_for(seed: int, level: float, factor: float) -> None:
    noise = np.random.default_rng(seed).normal(0.0, level, 10_000)
    assert burst_ratio(noise, factor * level) < BURSTS


@given(st.integers(0, 10_000), st.floats(3.0, 20.0))
def test_bursts_do(seed: int, times: float) -> None:
    rng = np.random.default_rng(seed)
    noise = rng.normal(0.0, 100.0, 10_000)
    for start in range(200, 10_000, 1000):
        noise[start : start + 200] += times * 100.0 * np.sin(np.arange(200))
    assert burst_ratio(noise, 100.0) > BURSTS


def test_too_few_samples_say_nothing() -> None:
    assert burst_ratio(np.ones(60), 1.0) == 0.0


def test_errors_within_rows_are_fast_and_a_pressure_of_single_samples_has_none() -> None:
    pressure = 3e5 + np.random.default_rng(3).normal(0.0, 100.0, 400)
    run = SimpleNamespace(noise=(100.0, 100.0), pressure=(pressure, pressure))
    every, groups = np.ones(400), np.arange(400) // 10
    ten = Rows(groups, np.zeros(40, dtype=int), np.full(40, 10.0), np.ones(40))
    rows = [ten, Rows(np.arange(400), np.zeros(400, dtype=int), every, every)]
    errors = np.column_stack([np.repeat(np.arange(40.0), 10) + np.tile([5.0, -5.0], 200)] * 2)
    ((fast, noise),) = fast_errors(run, errors, rows)  # type: ignore[arg-type]
    assert fast == pytest.approx(np.tile([5.0, -5.0], 200)) and noise >= 100.0


@pytest.mark.slow
def test_a_hose_that_rings_has_no_name(tmp_path: Path) -> None:
    write_case(make_case("case", effects=("ringing_hose",), seed=15, size=1.0, conditions=Conditions(known=())), tmp_path, "csv")
    found = diagnose(sorted(tmp_path.rglob("recording*.csv")), next(tmp_path.rglob("rig.toml")), folder=tmp_path)
    assert [finding.name for finding in found.effects if finding.kind != "calibration"] == ["unknown"]
    assert "bursts" in next(f for f in found.effects if f.kind == "unknown").says
