"""Errors of the whole machine run free and over windows, on cases of the proving ground."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from exo_sim import rig as rigs
from exo_sim.diagnosis.data.command_sign import reversed_command
from exo_sim.diagnosis.data.machine_data import MachineData
from exo_sim.diagnosis.data.split import Split
from exo_sim.diagnosis.pipeline.diagnose import diagnose
from exo_sim.diagnosis.pipeline.reading import gather
from exo_sim.diagnosis.validation import recorded_run
from exo_sim.diagnosis.validation.machine_runs import MachineRuns, Sums
from exo_sim.errors import ModelError, RecordingError
from exo_sim.machine.rig_model import load
from exo_sim.recording import read
from exo_sim.recording.table import Recording
from exo_sim.rig import Rig
from exo_sim.simulation.replay import WINDOW, replay, rms, usable
from exo_sim.trials.cases import make_case, write_case
from exo_sim.trials.conditions import Conditions
from exo_sim.trials.oracle import oracle_rig


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("leak")
    write_case(make_case("a", ("piston_leakage",), 11, 0.5, Conditions(duration=10.0)), folder, "parquet")
    return folder


def with_truth(folder: Path, effect: str, seed: int = 11, size: float = 0.5) -> tuple[MachineData, Rig]:
    """Write a case; return it, and its rig with the truth in it."""
    case = make_case("a", (effect,), seed, size, Conditions(duration=10.0, known=()))
    write_case(case, folder, "parquet", open_truth=True)
    rig = oracle_rig((folder / "rig.toml").read_text(), json.loads((folder / "truth.json").read_text())["hidden"])
    return gather([folder / "recording.parquet"], folder / "rig.toml"), rigs.parse(rig, folder / "rig.toml")


def kept(case: MachineData, start: float = 7.0, stop: float = 9.0) -> Split:
    return Split({case.recordings[0].name: ((start, stop),)})


def test_errors_are_those_of_compare_on_the_time_that_was_kept(bench: Path) -> None:
    path = bench / "recording.parquet"
    case = gather([path], bench / "rig.toml")
    found = MachineRuns(case, kept(case)).errors(case.rig)
    table = read(path).recording
    run = replay(table, case.rig, load(case.rig)).free_run
    inside = (table.time >= 7.0) & (table.time <= 9.0)
    assert set(found) == set(run.columns) == {"piston.pressure_1", "piston.pressure_2", "slide.position"}
    for key, fit in found.items():
        assert fit.before == fit.after == pytest.approx(rms(table[key][inside], run[key][inside]), rel=1e-12)
        assert 0.0 < fit.noise < fit.before and fit.unit == table.units[key]


def test_over_windows_the_whole_machine_is_run_around_what_was_kept(bench: Path) -> None:
    """From three seconds before on: then the gas has come to the temperature that it has in a run over all of the recording."""
    path = bench / "recording.parquet"
    case = gather([path], bench / "rig.toml")
    runs, rig = MachineRuns(case, kept(case), WINDOW), case.rig
    found, blocks = runs.errors(rig), runs.by_block(rig)
    table = read(path).recording
    run = replay(table, case.rig, load(case.rig)).windowed
    inside = (table.time >= 7.0) & (table.time <= 9.0)
    for key, fit in found.items():
        assert fit.before == fit.after == pytest.approx(rms(table[key][inside], run[key][inside]), rel=0.2)
        assert fit.after < 0.9 * MachineRuns(case, kept(case)).errors(rig)[key].after
        assert set(blocks[key]) >= {14, 15, 16, 17} and sum(block[0] for block in blocks[key].values()) == inside.sum()


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_a_run_that_begins_in_the_time_kept_is_one_of_a_recording_that_begins_there(bench: Path, share: float) -> None:
    path = bench / "recording.parquet"
    case = gather([path], bench / "rig.toml")
    found = MachineRuns(case, kept(case), part=(share, 1.0)).errors(case.rig)
    table = read(path).recording.span(7.0 + 2.0 * share, np.nextafter(9.0, math.inf))
    run = replay(table, case.rig, load(case.rig)).free_run
    assert set(found) == set(run.columns)
    for key, fit in found.items():
        assert fit.before == fit.after == pytest.approx(rms(table[key], run[key]), rel=1e-12)


def test_runs_from_several_states_share_no_time(bench: Path) -> None:
    case = gather([bench / "recording.parquet"], bench / "rig.toml")
    halves = [MachineRuns(case, kept(case), part=part).by_block(case.rig) for part in ((0.0, 0.5), (0.5, 1.0))]
    for key, blocks in halves[0].items():
        assert set(blocks) == {14, 15} and set(halves[1][key]) >= {16, 17} and 14 not in halves[1][key] and 15 not in halves[1][key]


def test_nothing_begins_where_less_than_a_window_is_left(bench: Path) -> None:
    case = gather([bench / "recording.parquet"], bench / "rig.toml")
    assert MachineRuns(case, kept(case, 7.0, 7.6), part=(0.5, 1.0)).errors(case.rig) == {}


@pytest.mark.parametrize("effect", ["supply_regulator", "supply_droop"])
def test_a_supply_that_was_measured_does_not_sag_twice(tmp_path: Path, effect: str) -> None:
    case, rig = with_truth(tmp_path, effect)
    assert "supply.pressure" in case.recordings[0]
    for key, fit in MachineRuns(case, kept(case)).errors(rig).items():
        assert fit.after == pytest.approx(fit.before), key


def test_what_a_measured_exhaust_shows_is_not_added_to_it(tmp_path: Path) -> None:
    case, rig = with_truth(tmp_path, "exhaust_back_pressure")
    table = case.as_read[0]
    level = np.full_like(table.time, 101325.0)
    columns, units = {**table.columns, "exhaust.pressure": level}, {**table.units, "exhaust.pressure": "Pa"}
    case = replace(case, as_read=(replace(table, columns=columns, units=units),))
    for key, fit in MachineRuns(case, kept(case)).errors(rig).items():
        assert fit.after == pytest.approx(fit.before), key


def test_a_command_with_the_wrong_sign_is_turned_round(tmp_path: Path) -> None:
    case, rig = with_truth(tmp_path, "piston_leakage")
    right = MachineRuns(case, kept(case)).errors(rig)
    table = case.as_read[0]
    opposite = replace(table, columns={**table.columns, "piston.valve_command": -table["piston.valve_command"]})
    case = replace(case, as_read=(opposite,))
    wrong = MachineRuns(case, kept(case)).errors(rig)
    assert wrong["piston.pressure_1"].after > 10.0 * right["piston.pressure_1"].after
    case = replace(case, sensors=(*case.sensors, reversed_command("piston")))
    assert MachineRuns(case, kept(case)).errors(rig) == right


@pytest.mark.parametrize("column", ["piston.valve_command", "piston.pressure_2"])
def test_nothing_is_run_where_something_would_have_to_be_assumed(tmp_path: Path, column: str) -> None:
    case, rig = with_truth(tmp_path, "piston_leakage")
    table = case.as_read[0]
    less = replace(table, columns={key: values for key, values in table.columns.items() if key != column})
    case = replace(case, as_read=(less,))
    assert MachineRuns(case, kept(case)).errors(rig) == {}


def test_a_few_samples_between_two_jumps_of_the_clock_are_no_lost_simulation(tmp_path: Path) -> None:
    case, rig = with_truth(tmp_path, "piston_leakage")
    table = case.as_read[0]
    time = table.time + 0.4 * (np.arange(len(table.time)) >= 7500) + 0.4 * (np.arange(len(table.time)) >= 7503)
    case = replace(case, as_read=(replace(table, time=time),))
    found = MachineRuns(case, kept(case, 7.0, 9.8)).errors(rig)
    assert found and all(math.isfinite(fit.before) and math.isfinite(fit.after) for fit in found.values())


def test_a_vessel_is_run_from_where_it_is_judged(tmp_path: Path) -> None:
    case, rig = with_truth(tmp_path, "piston_leakage")
    whole = MachineRuns(case, kept(case)).errors(rig)
    case = replace(case, cylinders={"piston": tuple(run.part(3000, len(run.time)) for run in case.cylinders["piston"])})
    part = MachineRuns(case, kept(case)).errors(rig)
    assert part.keys() == whole.keys() and part["piston.pressure_1"].before != whole["piston.pressure_1"].before


def test_recordings_that_are_long_are_left_to_compare(bench: Path) -> None:
    case = gather([bench / "recording.parquet"], bench / "rig.toml")
    case = replace(case, as_read=(replace(case.as_read[0], time=case.as_read[0].time * 100.0),))
    assert MachineRuns(case, kept(case, 700.0, 900.0)).errors(case.rig) == {}


def test_a_rig_that_cannot_be_run_where_the_one_handed_in_can_is_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case, right = with_truth(tmp_path, "piston_leakage")

    def refusing(recording: Recording, rig: Rig, *rest: object) -> object:
        if rig is right:
            raise RecordingError("nothing in it can be predicted")
        return usable(recording, rig, *rest)

    monkeypatch.setattr(recorded_run, "usable", refusing)
    found = MachineRuns(case, kept(case)).errors(right)
    assert found and all(math.isfinite(fit.before) and math.isnan(fit.after) for fit in found.values())


def test_a_rig_that_can_be_no_machine_is_refused(tmp_path: Path) -> None:
    case, right = with_truth(tmp_path, "piston_leakage")
    with pytest.raises(ModelError, match="nowhere"):
        MachineRuns(case, kept(case)).errors(replace(right, cylinders={"nowhere": right.cylinders["piston"]}))


def test_a_simulation_that_was_lost_has_no_error() -> None:
    sums = Sums("Pa")
    recorded = np.arange(4.0)
    sums.add(recorded, [recorded + 3.0, np.array([0.0, 1.0, math.nan, math.inf])], np.array([0, 0, 1, 1]))
    assert set(sums.blocks) == {0, 1} and sums.count == 4
    np.testing.assert_allclose(sums.blocks[0], [2.0, 18.0, 0.0])
    assert sums.result().before == pytest.approx(3.0) and math.isnan(sums.result().after)


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
    (begin, end), key = found.held_out["recording"][0], "piston.pressure_1"
    inside = (table.time >= begin) & (table.time <= end)
    assert rms(table[key][inside], run[key][inside]) == pytest.approx(found.free_run[key].after, rel=1e-9)
