"""The proof in one run, on cases of the proving ground."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from exo_sim import rig as rigs
from exo_sim.diagnosis.cases import gather
from exo_sim.diagnosis.diagnose import diagnose
from exo_sim.diagnosis.free_run import free_runs
from exo_sim.diagnosis.replay import replay, rms
from exo_sim.machine.load import load
from exo_sim.recording import read
from exo_sim.trials.cases import make_case, write_case


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("leak")
    write_case(make_case("a", ("piston_leakage",), 11, 0.5, duration=10.0), folder, "parquet")
    return folder


def test_errors_are_those_of_compare_on_the_time_that_was_kept(bench: Path) -> None:
    path = bench / "recording.parquet"
    case = gather([path], bench / "rig.toml")
    spans = {case.recordings[0].name: ((7.0, 9.0),)}
    found = free_runs(case, case.rig, spans)
    table = read(path).recording
    run = replay(table, case.rig, load(case.rig)).free_run
    inside = (table.time >= 7.0) & (table.time <= 9.0)
    assert set(found) == set(run.columns) == {"piston.pressure_1", "piston.pressure_2", "slide.position"}
    for key, fit in found.items():
        assert fit.before == fit.after == pytest.approx(rms(table[key][inside], run[key][inside]), rel=1e-12)
        assert 0.0 < fit.noise < fit.before and fit.unit == table.units[key]


def test_recordings_that_are_long_are_left_to_compare(bench: Path) -> None:
    case = gather([bench / "recording.parquet"], bench / "rig.toml")
    table = case.as_read[0]
    case.as_read = [replace(table, time=table.time * 100.0)]
    assert free_runs(case, case.rig, {table.name: ((700.0, 900.0),)}) == {}


def test_what_was_found_serves_a_run_that_no_measurement_corrects(bench: Path, tmp_path: Path) -> None:
    found = diagnose([bench / "recording.parquet"], bench / "rig.toml", folder=tmp_path)
    assert [finding.name for finding in found.effects if finding.kind != "calibration"] == ["piston_leakage"]
    pressures = [fit for key, fit in found.free_run.items() if "pressure" in key]
    assert len(pressures) == 2 and all(fit.after < fit.before for fit in pressures)
    data = found.as_dict()["fit"]["free_run"]
    assert {key: entry["after"] for key, entry in data.items()} == {key: fit.after for key, fit in found.free_run.items()}
    (tmp_path / "improved.toml").write_text(found.improved)
    improved = rigs.read(tmp_path / "improved.toml")
    table = read(bench / "recording.parquet").recording
    run = replay(table, improved, load(improved)).free_run
    (begin, end), key = found.held_out[0], "piston.pressure_1"
    inside = (table.time >= begin) & (table.time <= end)
    assert rms(table[key][inside], run[key][inside]) == pytest.approx(found.free_run[key].after, rel=1e-9)


def test_a_simulation_that_is_lost_has_no_error(bench: Path) -> None:
    case = gather([bench / "recording.parquet"], bench / "rig.toml")
    wild = replace(
        case.rig, cylinders={name: replace(c, valve_area=1e3 * c.valve_area) for name, c in case.rig.cylinders.items()}
    )
    found = free_runs(case, wild, {case.recordings[0].name: ((7.0, 9.0),)})
    assert all(math.isfinite(fit.before) for fit in found.values())
    assert all(math.isnan(fit.after) or fit.after > fit.before for key, fit in found.items() if "pressure" in key)
