"""The frame of the verb: files, texts, exit status. What a diagnosis finds is tested in tests/diagnosis."""

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from exo_sim import cli
from exo_sim.diagnosis.result import Diagnosis, Verdict
from exo_sim.recording import Recording, read, write_table

sys.path.insert(0, str(Path(__file__).parents[1] / "report"))
from report import made_up_diagnoses as made_up

ASSETS = Path(__file__).resolve().parents[2] / "assets"


@pytest.fixture
def answered(tmp_path, monkeypatch):
    """Return a function that sets what `diagnose` answers, and gives the list of what it was asked."""
    series = made_up.series()[0]
    for hours, name in enumerate(("monday", "tuesday")):
        recording = Recording(name, series.time + hours, {"piston.pressure_1": series.recorded}, {"piston.pressure_1": "Pa"})
        write_table(tmp_path / f"{name}.parquet", recording)
    shutil.copyfile(ASSETS / "bench.toml", tmp_path / "rig.toml")
    shutil.copyfile(ASSETS / "bench.xml", tmp_path / "bench.xml")  # comparison.rrd draws it
    monkeypatch.chdir(tmp_path)
    asked = []

    def answer(diagnosis):
        def diagnose(*arguments, **options):
            asked.append((arguments, options))
            options["progress"]("at it")
            return diagnosis

        monkeypatch.setattr("exo_sim.diagnosis.pipeline.diagnose.diagnose", diagnose)
        return asked

    return answer


@pytest.mark.parametrize(("verdict", "status"), [("consistent", 0), ("calibration", 0), ("mismatch", 3), ("undetermined", 4)])
def test_the_exit_status_is_the_verdict(answered, capsys, verdict, status):
    answered(Diagnosis(Verdict(verdict), ("monday",), "bench", improved=made_up.RIG))
    assert cli.main(["diagnose", "monday.parquet", "--rig", "rig.toml", "--out", "found"]) == status
    assert verdict.upper() in capsys.readouterr().out


def test_it_writes_page_rig_comparison_and_json(answered, capsys, tmp_path):
    asked = answered(made_up.whole())
    assert cli.main(["diagnose", "monday.parquet", "--rig", "rig.toml", "--out", "found", "--json", "--seed", "7"]) == 3
    data = json.loads(capsys.readouterr().out)
    assert data["schema"] == "exo-sim/diagnosis/1" and data["effects"][0]["name"] == "piston_leakage"
    folder = tmp_path / "found"
    assert {path.name for path in folder.iterdir()} == {"report.html", "improved.toml", "comparison.rrd", "diagnosis.json"}
    assert json.loads((folder / "diagnosis.json").read_text()) == {k: v for k, v in data.items() if k not in ("files", "time_s")}
    assert data["time_s"] >= 0.0
    assert (folder / "improved.toml").read_text() == made_up.whole().improved
    assert "Gas leaks past the piston." in (folder / "report.html").read_text()
    assert "piston.pressure_1" in read(folder / "comparison.rrd").recording
    (arguments, options), = asked
    assert arguments == ([Path("monday.parquet")], Path("rig.toml"))
    assert options["seed"] == 7 and options["column_map"] is None


def test_the_same_answer_is_written_byte_for_byte(answered, capsys, tmp_path):
    answered(made_up.whole())
    for folder in ("one", "two"):
        cli.main(["diagnose", "monday.parquet", "--rig", "rig.toml", "--out", folder, "--quiet"])
    for name in ("report.html", "improved.toml", "diagnosis.json"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_several_recordings_keep_the_names_that_the_diagnosis_gave_them(answered, tmp_path):
    names = ("monday", "monday (2)")
    every = tuple(replace(s, recording=name) for name in names for s in made_up.series())
    answered(made_up.whole(recordings=names, series=every))
    Path("later").mkdir()
    shutil.copyfile("tuesday.parquet", "later/monday.parquet")
    cli.main(["diagnose", "monday.parquet", "later/monday.parquet", "--rig", "rig.toml", "--out", "found", "--quiet"])
    assert len(read(tmp_path / "found" / "comparison.rrd").recording.time) == 2 * len(every[0].time)


def test_it_never_writes_over_the_rig_that_was_handed_in(answered, capsys, tmp_path):
    answered(made_up.whole())
    (tmp_path / "rig.toml").rename(tmp_path / "improved.toml")
    assert cli.main(["diagnose", "monday.parquet", "--rig", "improved.toml", "--out", "."]) == 2
    assert "it is the rig that was handed in" in capsys.readouterr().err
    assert (tmp_path / "improved.toml").read_bytes() == (ASSETS / "bench.toml").read_bytes()


def test_the_folder_may_not_be_a_file(answered, capsys):
    answered(made_up.whole())
    assert cli.main(["diagnose", "monday.parquet", "--rig", "rig.toml", "--out", "rig.toml"]) == 2
    assert "name a folder" in capsys.readouterr().err


def test_a_budget_is_handed_on_and_the_answer_says_that_it_ended_the_search(answered, capsys):
    asked = answered(replace(made_up.whole(), stopped=True))
    assert cli.main(["diagnose", "monday.parquet", "--rig", "rig.toml", "--out", "found", "--json", "--budget", "2 min"]) == 3
    assert json.loads(capsys.readouterr().out)["stopped"] is True
    assert asked[0][1]["budget"] == 120.0
    assert cli.main(["diagnose", "monday.parquet", "--rig", "rig.toml", "--out", "found", "--budget", "soon"]) == 2
    assert "soon" in capsys.readouterr().err


def test_without_a_budget_nothing_ends_early(answered, capsys):
    asked = answered(made_up.whole())
    cli.main(["diagnose", "monday.parquet", "--rig", "rig.toml", "--out", "found", "--json"])
    assert "stopped" not in json.loads(capsys.readouterr().out)
    assert asked[0][1]["budget"] == float("inf")
