"""A slow recording in whose gas nothing is found names what its rate hides."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.recording import read, write_table
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions


@pytest.mark.slow
def test_a_small_leak_that_fifty_samples_a_second_do_not_show_is_left_open(tmp_path: Path) -> None:
    write_case(make_case("a", ("piston_leakage",), 11, 0.15, Conditions(duration=20.0, known=())), tmp_path, "parquet")
    table = read(tmp_path / "recording.parquet").recording
    thinned = replace(table, time=table.time[::20], columns={key: values[::20] for key, values in table.columns.items()})
    write_table(tmp_path / "slow.parquet", thinned)
    found = diagnose([tmp_path / "slow.parquet"], tmp_path / "rig.toml", jobs=1)
    assert found.effects == ()
    (question,) = found.open_questions
    assert "piston_leakage" in question.effects
    assert "50 samples a second" in question.why and "500 Hz" in question.do
    assert found.next_experiment is not None and found.next_experiment.do == question.do
