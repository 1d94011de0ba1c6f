import json
import sys
from pathlib import Path

import pytest

from exo_sim import cli
from exo_sim.recording import read, write_table

sys.path.insert(0, str(Path(__file__).parents[1] / "diagnosis"))
import benches


@pytest.fixture
def case(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rig = benches.bench(tmp_path)
    write_table(tmp_path / "run.csv", benches.recorded(rig, 1.5))
    return tmp_path


def test_json_is_that_of_the_contract(case, capsys):
    assert cli.main(["compare", "run.csv", "--rig", "rig.toml", "--json", "--quiet"]) == 0
    out, err = capsys.readouterr()
    data = json.loads(out)
    assert data["schema"] == "exo-sim/compare/1" and isinstance(data["measure"], str)
    assert set(data["signal"]) == {"piston.pressure_1", "piston.pressure_2", "slide.position"}
    for signal in data["signal"].values():
        assert set(signal) == {"unit", "windowed_rms", "free_run_rms", "noise"}
    assert data["signal"]["piston.pressure_1"]["free_run_rms"] < 500.0
    assert err == ""
    assert read(case / "run_compared.rrd").recording["piston.pressure_1"].shape == (1500,)


def test_nothing_is_held_against_a_sensor_that_cannot_be_believed(case, capsys):
    text = (case / "run.csv").read_text().replace("piston.pressure_1 [Pa]", "piston.pressure_1 [kPa]")
    (case / "run.csv").write_text(text)
    assert cli.main(["compare", "run.csv", "--rig", "rig.toml", "--json"]) == 0
    out, err = capsys.readouterr()
    assert set(json.loads(out)["signal"]) == {"piston.pressure_2", "slide.position"}
    assert '"piston.pressure_1"' in err and "is the unit right?" in err


def test_a_table_for_people(case, capsys):
    assert cli.main(["compare", "run.csv", "--rig", "rig.toml", "--out", "there/both.rrd", "--motion", "recorded"]) == 0
    out, err = capsys.readouterr()
    assert "piston.pressure_1  Pa" in out and "slide.position" not in out
    assert "motion of slide is led as recorded: as asked" in err
    assert (case / "there" / "both.rrd").stat().st_size > 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["compare", "run.csv"], "rig"),
        (["compare", "rin.csv", "--rig", "rig.toml"], 'did you mean "run.csv"'),
        (["compare", "run.csv", "--rig", "rig.toml", "--out", "x.csv"], "ends in .rrd"),
        (["compare", "run.csv", "--rig", "rig.toml", "--motion", "predictd"], 'did you mean "predicted"'),
    ],
)
def test_bad_input_is_one_line(case, capsys, arguments, words):
    assert cli.main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and words in err
