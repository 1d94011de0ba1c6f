"""What is too fast for the rows of a gas's fit: a sensor's noise is even, a pressure that rings comes in bursts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.diagnosis.policy.healthy import BURSTS
from exo_sim.diagnosis.subsystems.gas.bursts import burst_ratio
from exo_sim.trials.cases import make_case, write_case


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


@pytest.mark.slow
def test_a_hose_that_rings_has_no_name(tmp_path: Path) -> None:
    write_case(make_case("case", effects=("ringing_hose",), seed=15, size=1.0, known="none"), tmp_path, "csv")
    found = diagnose(sorted(tmp_path.rglob("recording*.csv")), next(tmp_path.rglob("rig.toml")), folder=tmp_path)
    assert [finding.name for finding in found.effects if finding.kind != "calibration"] == ["unknown"]
    assert "bursts" in next(f for f in found.effects if f.kind == "unknown").says
