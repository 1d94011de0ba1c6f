"""Recordings and rig put side by side: files or tables, faults that are seen without physics, and another machine's columns."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import benches
import numpy as np
import pytest

from exo_sim.diagnosis.findings import Kind
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.subsystems.motion.motion_runs import motion_runs
from exo_sim.errors import RecordingError
from exo_sim.recording import Finding, Recording, write_table
from exo_sim.recording.reader import Reading
from exo_sim.simulation.replay.machine import RecordedMachine


@pytest.fixture
def table(tmp_path: Path) -> Recording:
    return benches.led(benches.bench(tmp_path), 2.0)


def reading(table: Recording) -> Reading:
    return Reading(table, ())


def test_a_file_and_the_table_in_it_are_the_same_machine_data(tmp_path: Path, table: Recording) -> None:
    write_table(tmp_path / "bench.csv", table)
    filed, held = gather([tmp_path / "bench.csv"], tmp_path / "rig.toml"), gather([reading(table)], benches.bench(tmp_path))
    for one in (filed, held):
        assert set(one.cylinders) == {"piston"} and one.sensors == ()
    for key, values in held.recordings[0].columns.items():
        np.testing.assert_allclose(filed.recordings[0][key], values, rtol=1e-12)


def test_two_recordings_of_one_name_are_distinguished(tmp_path: Path, table: Recording) -> None:
    data = gather([reading(table), reading(table)], tmp_path / "rig.toml")
    assert [one.name for one in data.recordings] == ["bench", "bench'"] and len(data.cylinders["piston"]) == 2


def test_a_stuck_sensor_is_a_finding_and_its_samples_are_left_out(tmp_path: Path, table: Recording) -> None:
    noisy = {k: v + np.random.default_rng(3).normal(0.0, 100.0, len(v)) if "pressure" in k else v for k, v in table.columns.items()}
    noisy["piston.pressure_1"][500:1300] = noisy["piston.pressure_1"][500]
    data = gather([reading(replace(table, columns=noisy))], tmp_path / "rig.toml")
    (finding,) = data.sensors
    assert (finding.name, finding.where, finding.kind) == ("sensor_stuck", "piston.pressure_1", Kind.SENSOR)
    assert np.isnan(data.recordings[0]["piston.pressure_1"][600:1200]).all()
    assert np.isfinite(data.as_read[0]["piston.pressure_1"]).all()


def test_nothing_runs_across_a_mended_clock(tmp_path: Path, table: Recording) -> None:
    """A logger that sets its clock back for 0.1 s: from there on the pressures are those of 0.1 s later."""
    write_table(tmp_path / "bench.csv", replace(table, time=table.time - 0.1 * (np.arange(len(table.time)) >= 1350)))
    data = gather([tmp_path / "bench.csv"], tmp_path / "rig.toml")
    begun = int(np.searchsorted(data.recordings[0].time, 1.3495))
    assert data.recordings[0].breaks == (pytest.approx(1.35),)
    (balance,), _ = motion_runs(data.recordings[0], data.rig, data.model, data.links)
    assert data.cylinders["piston"][0].breaks == balance.breaks == (0, begun)
    assert [piece.first for piece in RecordedMachine(data.recordings[0], data.rig, data.model).pieces] == [0, begun]
    speed, slowest = data.cylinders["piston"][0].speed, 0.04 * 2.0 * np.pi
    assert speed is not None and np.abs(speed).max() < 1.01 * slowest  # a position that jumps is no speed


def test_another_machines_recording_is_refused_with_the_nearest_part(tmp_path: Path, table: Recording) -> None:
    columns = {key.replace("piston.", "pistom.").replace("slide.", "slidr."): values for key, values in table.columns.items()}
    units = {key.replace("piston.", "pistom.").replace("slide.", "slidr."): unit for key, unit in table.units.items()}
    with pytest.raises(RecordingError, match=r'"pistom" is none of its parts.*piston'):
        gather([reading(Recording("bench", table.time, columns, units))], tmp_path / "rig.toml")


def test_a_misspelt_signal_is_the_first_remark(tmp_path: Path, table: Recording) -> None:
    path = tmp_path / "bench.csv"
    write_table(path, table)
    path.write_text(path.read_text().replace("piston.pressure_2", "piston.presure_2", 1).replace("e-02", "word", 1))
    data = gather([path], tmp_path / "rig.toml")
    assert "presure_2" in data.remarks[0] and len([one for one in data.remarks if "presure_2" in one and "set aside" in one]) >= 1
    assert data.checks[0].meant == "piston.pressure_2"


def test_a_column_that_the_reader_could_not_use_is_a_check_where_it_is_one_of_this_machine(tmp_path: Path, table: Recording) -> None:
    gone = [Finding(f"{part}.pressure_1 [mm]", "unit", "", severity="fault", use="set aside") for part in ("piston", "cellar")]
    spans = Finding("slide.position", "unit", "", ((0, 4),), severity="fault", use="set aside")
    checks = gather([Reading(table, (*gone, spans))], benches.bench(tmp_path)).checks
    assert [check.columns for check in checks if check.what == "unread"] == [("piston.pressure_1 [mm]",)]
